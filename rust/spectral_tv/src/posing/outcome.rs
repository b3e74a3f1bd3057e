//! The result of posing.

use ndarray::Array2;

/// A pose.
#[derive(Debug, Clone)]
pub struct Pose {
    /// x − p, (3, V), length.
    pub displacement: Array2<f64>,
    /// R as unit quaternions w, x, y, z, (4, V).
    pub rotations: Array2<f64>,
    /// E, length²; 0 for a rigid motion at rest.
    pub energy: f64,
    /// A certificate: by how much the quadratic model says the energy could be less, relative to
    /// it. 0 at a stationary point; `None` where a drag did not measure it.
    pub decrement: Option<f64>,
    /// The largest movement of a vertex in the last iteration, length.
    pub movement: f64,
    /// Iterations.
    pub iterations: usize,
}
