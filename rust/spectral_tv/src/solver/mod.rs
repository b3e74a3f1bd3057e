//! Solvers for the symmetric positive definite systems of a step.
//!
//! [`LinearSolver`] is what steps use: it chooses between a [`Cholesky`] factorization and
//! [`Multigrid`].

mod cholesky;
mod conjugate_gradients;
mod linear_solver;
mod multigrid;

pub use cholesky::Cholesky;
pub use conjugate_gradients::conjugate_gradients;
pub use linear_solver::{LinearSolver, Solver};
pub use multigrid::Multigrid;
