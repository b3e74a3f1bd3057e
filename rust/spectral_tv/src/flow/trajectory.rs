//! The states a flow passes through, and what was measured on the way.

use ndarray::{Array1, Array2, Array3, ArrayView1, ArrayView2, Axis};

use crate::error::{Error, Result};
use crate::monitor::Stage;
use crate::operators::{Discretization, total_variation};

/// A flow sampled at N + 1 times.
#[derive(Debug, Clone)]
pub struct Trajectory {
    /// t₀ = 0 < t₁ < … < t_N.
    pub times: Vec<f64>,
    /// u(t_k), (N + 1, C, V).
    pub states: Array3<f64>,
    /// TV(u(t_k)) over all channels together, N + 1.
    pub total_variation: Vec<f64>,
    /// Duality gap of each step relative to τ TV at its start, N; 0 for linear steps.
    pub gaps: Vec<f64>,
}

impl Trajectory {
    /// A flow from `initial` (C, V) whose states are known: `state` gives u(t_k) for k > 0.
    ///
    /// # Errors
    /// If the times do not increase from 0, a value is not finite, or the monitor was cancelled.
    pub fn sampled(
        operators: &Discretization,
        times: &[f64],
        initial: &Array2<f64>,
        stage: Stage,
        mut state: impl FnMut(usize) -> Array2<f64>,
    ) -> Result<Self> {
        let mut record = Recorder::new(operators, initial.view(), times)?;
        for k in 1..times.len() {
            stage.report(k as f64 / times.len() as f64)?;
            let state = state(k);
            let variation = total_variation(operators.gradient(), state.view());
            let (gap, tau) = (0.0, times[k] - times[k - 1]);
            record.push(&Solution { state, gap, tau }, variation);
        }
        stage.report(1.0)?;
        Ok(record.finish())
    }

    /// Mean of u(t_k) over the surface weighted by `weights` (V), (N + 1, C): the value of a set
    /// where the weights indicate it. `masses` are the V vertex areas.
    ///
    /// # Errors
    /// If the weights are not V values of 0 or more, or give no area at all.
    pub fn mean(&self, weights: &[f64], masses: &[f64]) -> Result<Array2<f64>> {
        if weights.len() != masses.len() {
            return Err(Error::Argument(format!(
                "weights must have one value per vertex ({}), but has {}",
                masses.len(),
                weights.len()
            )));
        }
        if let Some(v) = weights.iter().position(|w| !(*w >= 0.0 && w.is_finite())) {
            return Err(Error::Argument(format!(
                "weights[{v}] must be 0 or more and finite, not {}",
                weights[v]
            )));
        }
        let parts: Array1<f64> = weights.iter().zip(masses).map(|(w, m)| w * m).collect();
        let total = parts.sum();
        if total <= 0.0 {
            return Err(Error::Argument(
                "the weights give no vertex any area".into(),
            ));
        }
        let mean = |values: ArrayView1<f64>| values.dot(&parts) / total;
        Ok(self.states.map_axis(Axis(2), mean))
    }
}

/// What a step arrived at.
#[derive(Debug, Clone)]
pub(super) struct Solution {
    /// u⁺ (C, V).
    pub state: Array2<f64>,
    /// Duality gap of the step's minimisation, absolute.
    pub gap: f64,
    /// The step length τ that the gap is measured against.
    pub tau: f64,
}

/// TV relative to the initial one below which nothing is left to decay.
const EXTINCT: f64 = 1e-9;

/// Collects the states of a running flow.
pub(super) struct Recorder {
    trajectory: Trajectory,
}

impl Recorder {
    /// Starts at `initial` (C, V).
    ///
    /// # Errors
    /// If the times do not increase from 0, or a value is not finite.
    pub fn new(
        operators: &Discretization,
        initial: ArrayView2<f64>,
        times: &[f64],
    ) -> Result<Self> {
        check_times(times)?;
        operators.check_values(initial)?;
        let (channels, vertices) = initial.dim();
        let mut states = Array3::zeros((times.len(), channels, vertices));
        states.index_axis_mut(Axis(0), 0).assign(&initial);
        let trajectory = Trajectory {
            times: times.to_vec(),
            states,
            total_variation: vec![total_variation(operators.gradient(), initial)],
            gaps: Vec::new(),
        };
        Ok(Self { trajectory })
    }

    /// u(t_k).
    pub fn state(&self, k: usize) -> ArrayView2<'_, f64> {
        self.trajectory.states.index_axis(Axis(0), k)
    }

    /// Whether the last state recorded is constant on every component, up to rounding.
    pub fn is_extinct(&self) -> bool {
        self.last_total_variation() <= EXTINCT * self.trajectory.total_variation[0]
    }

    /// Total variation of the last state recorded.
    pub fn last_total_variation(&self) -> f64 {
        *self
            .trajectory
            .total_variation
            .last()
            .expect("starts with one")
    }

    /// Takes the state at the next time, and its TV.
    pub fn push(&mut self, solution: &Solution, total_variation: f64) {
        let start = self.last_total_variation();
        let gap = match self.is_extinct() {
            true => 0.0,
            false => solution.gap / (solution.tau * start),
        };
        let k = self.trajectory.total_variation.len();
        self.trajectory
            .states
            .index_axis_mut(Axis(0), k)
            .assign(&solution.state);
        self.trajectory.total_variation.push(total_variation);
        self.trajectory.gaps.push(gap);
    }

    /// The finished trajectory.
    pub fn finish(self) -> Trajectory {
        self.trajectory
    }
}

fn check_times(times: &[f64]) -> Result<()> {
    if times.len() < 2 {
        return Err(Error::Argument(format!(
            "times needs at least two values, 0 and an end; it has {}",
            times.len()
        )));
    }
    if times[0] != 0.0 {
        return Err(Error::Argument(format!(
            "times[0] must be 0, not {}",
            times[0]
        )));
    }
    for (k, pair) in times.windows(2).enumerate() {
        if !(pair[1] > pair[0] && pair[1].is_finite()) {
            return Err(Error::Argument(format!(
                "times must increase and be finite, but times[{}] is {} after {}",
                k + 1,
                pair[1],
                pair[0]
            )));
        }
    }
    Ok(())
}
