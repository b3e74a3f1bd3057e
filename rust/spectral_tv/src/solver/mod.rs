//! Solvers for the symmetric positive definite systems of a step, and for eigenpairs.
//!
//! [`LinearSolver`] is what steps use: it chooses between a [`Cholesky`] factorization and
//! [`Multigrid`].

mod block_lanczos;
mod cholesky;
mod conjugate_gradients;
#[cfg(test)]
mod examples;
mod linear_solver;
mod multigrid;
mod scratch;

pub use block_lanczos::{Operator, largest_eigenpairs};
pub use cholesky::{Cholesky, Symbolic};
pub use conjugate_gradients::conjugate_gradients;
pub use linear_solver::{Demand, LinearSolver, Solver};
pub use multigrid::Multigrid;
pub use scratch::warm_up;
