//! Solvers for the symmetric positive definite systems of a step.

mod cholesky;
mod conjugate_gradients;

pub use cholesky::Cholesky;
pub use conjugate_gradients::conjugate_gradients;
