//! The flow of a function on a mesh.

use ndarray::Array2;

use crate::discretization::Discretization;
use crate::error::Result;
use crate::flow::heat::Heat;
use crate::flow::law::Law;
use crate::flow::stepping::Stepping;
use crate::flow::total_variation::TotalVariation;
use crate::flow::trajectory::Trajectory;
use crate::memory::needs;
use crate::mesh::TriangleMesh;
use crate::monitor::{Monitor, Stage};
use crate::named::named;

named! {
    /// The law by which a function flows, in the metric of the mesh.
    pub enum Operator: "operator" {
        /// u_t ∈ −∂NETV(u) (Brokman et al. 2024, Eq. 20), channels coupled.
        #[default]
        TotalVariation = "tv",
        /// u_t = Δu (Eq. 12).
        Heat = "heat",
    }
}

impl Operator {
    fn law(self, operators: &Discretization, values: &Array2<f64>) -> Result<Box<dyn Law>> {
        Ok(match self {
            Self::TotalVariation => {
                Box::new(TotalVariation::starting_at(operators, values.view())?)
            }
            Self::Heat => Box::new(Heat),
        })
    }
}

/// Flows a function with the `values` (C, V) on `mesh` through `times`, which increase from 0: in the
/// unit of the values × length for TV, length² for heat.
///
/// # Errors
/// As [`Stepping::run`].
pub fn flow(
    mesh: &TriangleMesh,
    values: Array2<f64>,
    times: &[f64],
    operator: Operator,
    stepping: Stepping,
) -> Result<Trajectory> {
    flow_with(
        mesh,
        values,
        times,
        operator,
        stepping,
        Monitor::new().whole(),
    )
    .map(|(flow, _)| flow)
}

/// [`flow`], watched: `stage` tells how far it is, and cancels it. Also returns the areas of the
/// vertices that the flow went by, (V,).
///
/// # Errors
/// As [`flow`], or [`crate::Error::Cancelled`].
pub fn flow_with(
    mesh: &TriangleMesh,
    values: Array2<f64>,
    times: &[f64],
    operator: Operator,
    stepping: Stepping,
    stage: Stage,
) -> Result<(Trajectory, Vec<f64>)> {
    stepping.check()?;
    stepping.require(needs::Size::of(mesh), values.dim(), times, stage)?;
    let operators = Discretization::new(mesh, stage)?;
    let law = operator.law(&operators, &values)?;
    let trajectory = stepping.run(&operators, &*law, values, times, stage)?;
    Ok((trajectory, operators.masses().to_vec()))
}
