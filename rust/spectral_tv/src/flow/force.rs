//! The force of a step: the weights of a law at given gradients, and their Laplacian.

use std::borrow::Cow;

use ndarray::{Array2, ArrayView2, Zip};

use crate::discretization::Discretization;
use crate::error::Result;
use crate::flow::law::Law;
use crate::flow::time_step::TimeStep;
use crate::monitor::Stage;
use crate::operators::SideBySide;
use crate::parallel;

/// L(w) with w of given gradients, and L(w) u of a state.
pub(super) struct Force {
    /// w of every face.
    pub weights: Vec<f64>,
    /// L(w), see [`crate::operators::EdgeLaplacian`].
    pub couplings: Vec<f64>,
    /// L(w) u, (C, V).
    pub flux: Array2<f64>,
}

impl Force {
    /// The weights of `law` for |∇u| = `norms`, applied to `state` (C, V).
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn new(
        operators: &Discretization,
        law: &dyn Law,
        norms: Cow<[f64]>,
        state: ArrayView2<f64>,
        stage: Stage,
    ) -> Result<Self> {
        let edges = operators.edges();
        let weights = stage.pass(|| law.weights(&norms))?;
        drop(norms);
        let couplings = stage.pass(|| edges.couplings(operators.gradient(), &weights))?;
        // Not before the couplings, which take memory while they are made.
        let lanes = stage.pass(|| SideBySide::from(state))?;
        let flux = stage.pass(|| edges.apply(&couplings, &lanes))?;
        Ok(Self {
            flux,
            weights,
            couplings,
        })
    }

    /// M(û − u) − τ L u, (C, V): the residual of the step at the state u.
    pub fn residual(self, step: &TimeStep, masses: &[f64], state: ArrayView2<f64>) -> Array2<f64> {
        let mut residual = self.flux;
        let rows = residual.rows_mut().into_iter().zip(step.data.rows());
        for ((mut row, data), state) in rows.zip(state.rows()) {
            let tau = step.tau;
            Zip::from(&mut row)
                .and(&data)
                .and(&state)
                .and(masses)
                .par_for_each(|flux, data, state, mass| {
                    *flux = mass * (data - state) - tau * *flux
                });
        }
        residual
    }

    /// Duality gap of a step of TV flow at the state u that this is the force of: primal minus
    /// dual energy of min ½‖u − û‖²_M + τ TV(u), for the dual field w ∇u, which TV's weights
    /// keep below 1. A sum of non-negative terms, so that it loses no digits.
    pub fn gap(
        &self,
        operators: &Discretization,
        step: &TimeStep,
        norms: &[f64],
        state: ArrayView2<f64>,
    ) -> f64 {
        let masses = operators.masses();
        let distance = parallel::sum(masses.len(), |vertices| {
            let mut distance = 0.0;
            let flux = parallel::columns(self.flux.view(), vertices.clone());
            for (channel, flux) in flux.rows().into_iter().enumerate() {
                for (vertex, flux) in vertices.clone().zip(flux) {
                    let mass = masses[vertex];
                    let off = step.data[[channel, vertex]] - state[[channel, vertex]];
                    distance += 0.5 * (mass * off - step.tau * flux).powi(2) / mass;
                }
            }
            distance
        });
        let areas = operators.gradient().face_areas();
        let excess = parallel::sum(areas.len(), |faces| {
            let sizes = norms[faces.clone()]
                .iter()
                .zip(&self.weights[faces.clone()]);
            let terms = sizes.zip(&areas[faces]);
            terms
                .map(|((n, w), area)| area * (n - w * n * n).max(0.0))
                .sum()
        });
        distance + step.tau * excess
    }
}

/// Σ A n over the faces: TV from |∇u| = `norms`.
pub(super) fn variation(operators: &Discretization, norms: &[f64]) -> f64 {
    let areas = operators.gradient().face_areas();
    parallel::sum(areas.len(), |faces| {
        let faces = norms[faces.clone()].iter().zip(&areas[faces]);
        faces.map(|(n, area)| n * area).sum()
    })
}
