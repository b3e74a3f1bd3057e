//! Errors, which tell the caller where the fault is.

mod argument;

use ndarray::ArrayView2;
use thiserror::Error;

pub use argument::{ArgumentError, Fault};

/// The result of every fallible function of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// Whether a number is finite, and not so large that products of several overflow: at most 1e100.
pub(crate) fn has_usable_size(value: f64) -> bool {
    value.abs() <= 1e100
}

/// Why a call was refused or ended early.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Error {
    /// Coordinates are NaN, infinite or too large.
    #[error(
        "vertex {} has a coordinate that is not finite, or beyond 1e100: {position:?}{}",
        vertices[0], others(vertices)
    )]
    NonFiniteVertices {
        /// Indices of the vertices, at least one.
        vertices: Vec<usize>,
        /// The position of the first.
        position: [f64; 3],
    },
    /// Triangles refer to vertices that do not exist.
    #[error(
        "triangle {} refers to vertex {index}, but the vertices are 0 to {last}{}",
        triangles[0], others(triangles)
    )]
    IndicesOutOfRange {
        /// Indices of the triangles, at least one.
        triangles: Vec<usize>,
        /// The index found in the first.
        index: i64,
        /// The largest valid index.
        last: usize,
    },
    /// The mesh has too few or too many elements to work on.
    #[error("{0}")]
    Unusable(String),
    /// An argument cannot be used.
    #[error(transparent)]
    Argument(ArgumentError),
    /// Values of vertices are NaN, infinite or too large.
    #[error(
        "the value of vertex {}, channel {channel}, is not finite, or beyond 1e100: {value:?}{}",
        vertices[0], others(vertices)
    )]
    NonFiniteValues {
        /// Indices of the vertices, at least one.
        vertices: Vec<usize>,
        /// Index of the first one's channel.
        channel: usize,
        /// The value found there.
        value: f64,
    },
    /// Coordinates of a base shape are NaN, infinite or too large.
    #[error(
        "base vertex {} has a coordinate ({axis}) that is not finite, or beyond 1e100: {value:?}{}",
        vertices[0], others(vertices)
    )]
    NonFiniteBase {
        /// Indices of the vertices, at least one.
        vertices: Vec<usize>,
        /// The axis of the first one's coordinate.
        axis: usize,
        /// The coordinate.
        value: f64,
    },
    /// A linear system could not be solved.
    #[error("the linear system of a step could not be solved: {0}")]
    Solver(String),
    /// The work takes more memory than there is.
    #[error("{0}")]
    Memory(String),
    /// The caller asked for the work to stop.
    #[error("cancelled")]
    Cancelled,
}

impl From<ArgumentError> for Error {
    fn from(error: ArgumentError) -> Self {
        Self::Argument(error)
    }
}

impl Error {
    /// The vertices that are at fault, all of them; none where the fault is not theirs.
    pub fn vertices(&self) -> &[usize] {
        match self {
            Self::NonFiniteVertices { vertices, .. }
            | Self::NonFiniteValues { vertices, .. }
            | Self::NonFiniteBase { vertices, .. } => vertices,
            _ => &[],
        }
    }

    /// The triangles that are at fault, likewise.
    pub fn triangles(&self) -> &[usize] {
        match self {
            Self::IndicesOutOfRange { triangles, .. } => triangles,
            _ => &[],
        }
    }
}

/// How many elements a message does not name, as its end.
fn others(elements: &[usize]) -> String {
    match elements.len() - 1 {
        0 => String::new(),
        count => format!("; so it is with {count} more"),
    }
}

/// Of the values (C, V) of vertices, all vertices with an unusable one, and the first of these
/// with its channel and value.
pub(crate) fn unusable_values(values: ArrayView2<f64>) -> Option<(Vec<usize>, usize, f64)> {
    let is_usable = |vertex: &usize| {
        let channels = values.column(*vertex);
        channels.iter().all(|value| has_usable_size(*value))
    };
    let vertices: Vec<_> = (0..values.ncols()).filter(|v| !is_usable(v)).collect();
    let channels = values.column(*vertices.first()?);
    let channel = channels.iter().position(|value| !has_usable_size(*value))?;
    let value = channels[channel];
    Some((vertices, channel, value))
}
