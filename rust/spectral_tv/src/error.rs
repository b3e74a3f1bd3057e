//! What can go wrong, said so that the caller finds the place.

use thiserror::Error;

/// The result of every fallible function of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// Whether a number is finite, and not so large that products of several overflow: at most 1e100.
pub(crate) fn has_usable_size(value: f64) -> bool {
    value.abs() <= 1e100
}

/// Why a call was refused or ended early.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Error {
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not finite: {position:?}")]
    NonFiniteVertex {
        /// Index of the vertex.
        vertex: usize,
        /// Its position.
        position: [f64; 3],
    },
    /// A triangle refers to a vertex that does not exist.
    #[error("triangle {triangle} refers to vertex {index}, but the vertices are 0 to {last}")]
    IndexOutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// The index found there.
        index: i64,
        /// The largest valid index.
        last: usize,
    },
    /// The mesh has too few or too many elements to work on.
    #[error("{0}")]
    Unusable(String),
    /// The value of an argument makes no sense.
    #[error("{0}")]
    Argument(String),
    /// A per-vertex value is NaN or infinite.
    #[error(
        "the value of vertex {vertex}, channel {channel}, is not finite, or beyond 1e100: {value}"
    )]
    NonFiniteValue {
        /// Index of the vertex.
        vertex: usize,
        /// Index of the channel.
        channel: usize,
        /// The value found there.
        value: f64,
    },
    /// A linear system could not be solved.
    #[error("the linear system of a step could not be solved: {0}")]
    Solver(String),
    /// The caller asked for the work to stop.
    #[error("cancelled")]
    Cancelled,
}
