//! One implicit step in time as a proximal problem, given by its data and its length.

use ndarray::{Array2, ArrayView2};

use crate::flow::increment::Increment;
use crate::parallel;

/// Growth of the step beyond which variable-step BDF2 is not trusted (it is zero-stable below
/// 1 + √2; Grigorieff 1983).
const LARGEST_GROWTH: f64 = 2.0;

/// (M + τ L) u⁺ = M `data`: both backward Euler and BDF2 are of this form.
#[derive(Debug, Clone)]
pub struct TimeStep {
    /// û (C, V): the state, or the combination of the last two.
    pub data: Array2<f64>,
    /// τ, length² for shape flows.
    pub tau: f64,
}

/// The last state and the one before, with the steps in time around them.
#[derive(Debug, Clone, Copy)]
pub struct History<'a> {
    /// u(t_k), (C, V).
    pub state: ArrayView2<'a, f64>,
    /// u(t_k) − u(t_{k−1}) and t_k − t_{k−1}, from the second step on.
    pub previous: Option<(&'a Increment, f64)>,
}

impl TimeStep {
    /// Backward Euler: û = u, τ = Δt.
    pub fn backward_euler(history: &History, dt: f64) -> Self {
        Self {
            data: history.state.to_owned(),
            tau: dt,
        }
    }

    /// Variable-step BDF2: û = u + κ (u − u₋), κ = ω²/(1 + 2ω), τ = Δt (1 + ω)/(1 + 2ω).
    pub fn bdf2(state: ArrayView2<f64>, usable: &Usable, dt: f64) -> Self {
        let growth = usable.growth;
        let kappa = growth * growth / (1.0 + 2.0 * growth);
        let mut data = state.to_owned();
        usable.increment.add_to(kappa, &mut data);
        Self {
            data,
            tau: dt * (1.0 + growth) / (1.0 + 2.0 * growth),
        }
    }

    /// ⟨û − u, d⟩ in the mass M = `masses`, for a state u and a direction d, (C, V) each.
    pub fn pull<'a>(
        &'a self,
        masses: &[f64],
        state: ArrayView2<'a, f64>,
        direction: ArrayView2<'a, f64>,
    ) -> f64 {
        parallel::sum(masses.len(), |vertices| {
            let masses = &masses[vertices.clone()];
            let part = |values: ArrayView2<'a, f64>| parallel::columns(values, vertices.clone());
            let [data, state, direction] = [self.data.view(), state, direction].map(part);
            let channels = data.rows().into_iter().zip(state.rows());
            let channels = channels.zip(direction.rows());
            channels
                .map(|((data, state), direction)| {
                    let values = data.iter().zip(state).zip(direction).zip(masses);
                    let terms = values.map(|(((data, state), direction), mass)| {
                        mass * (data - state) * direction
                    });
                    terms.sum::<f64>()
                })
                .sum()
        })
    }
}

/// A step before that can be extrapolated from.
pub struct Usable<'a> {
    /// u − u₋, (C, V).
    pub increment: &'a Increment,
    /// ω = Δt/Δt₋.
    pub growth: f64,
}

impl<'a> History<'a> {
    /// What a step of length `dt` can be extrapolated from; `None` where there is no history or
    /// the step grows too much.
    pub fn usable(&self, dt: f64) -> Option<Usable<'a>> {
        let (increment, previous_dt) = self.previous?;
        let growth = dt / previous_dt;
        (growth <= LARGEST_GROWTH).then_some(Usable { increment, growth })
    }
}
