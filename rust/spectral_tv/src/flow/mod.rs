//! Flows u_t = −p(u), u(0) = f: the laws that drive them, and the ways to take a step.
//!
//! `heat`, `total_variation` and `conformal` are the laws; `semi_implicit` and `proximal` are the
//! ways to step. A new flow is a new law. `laplace_beltrami` computes its states without steps.

mod conformal;
mod correction;
mod descent;
mod dual_steps;
mod duality_gap;
mod force;
mod function;
mod heat;
mod increment;
mod laplace_beltrami;
mod law;
mod line;
mod means;
mod origin;
mod prediction;
mod proximal;
mod proximal_newton;
mod recorder;
mod rigid_parts;
mod sampled;
mod semi_implicit;
mod step_system;
mod stepping;
mod time_step;
mod times;
mod total_variation;
mod trajectory;
mod velocity;

pub use crate::solver::Solver;
pub use conformal::{
    ConformalLaplace, conformal_mean_curvature_flow, conformal_mean_curvature_flow_with,
};
pub use function::{Operator, flow, flow_with};
pub use heat::Heat;
pub use increment::Increment;
pub use laplace_beltrami::Eigenpairs;
pub use law::Law;
pub(crate) use origin::without;
pub(crate) use proximal::proximal_flow;
#[cfg(test)]
pub(crate) use semi_implicit::{Weights, semi_implicit_flow};
pub use stepping::{Scheme, Stepping};
pub(crate) use times::{check_steps, check_times};
pub use total_variation::TotalVariation;
pub use trajectory::Trajectory;
pub(crate) use velocity::velocity;
