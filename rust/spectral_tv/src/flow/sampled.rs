//! Flows whose states are known without steps.

use ndarray::{Array1, Array2};

use crate::discretization::Discretization;
use crate::error::Result;
use crate::flow::increment::Precision;
use crate::flow::recorder::{Recorder, Solution};
use crate::flow::trajectory::Trajectory;
use crate::monitor::{Monitor, Stage};

impl Trajectory {
    /// A flow from `initial` (C, V) whose states are known: `state` gives u(t_k) for k > 0, less the
    /// constant (C) that it is given.
    ///
    /// # Errors
    /// If the times do not increase from 0, or a value is not finite.
    pub fn sampled(
        operators: &Discretization,
        times: &[f64],
        initial: Array2<f64>,
        state: impl FnMut(usize, &Array1<f64>) -> Array2<f64>,
    ) -> Result<Self> {
        Self::sampled_with(operators, times, initial, state, Monitor::new().whole())
    }

    /// [`Self::sampled`], watched: `stage` tells how far it is, and cancels it.
    ///
    /// # Errors
    /// As [`Self::sampled`], or [`crate::Error::Cancelled`].
    pub fn sampled_with(
        operators: &Discretization,
        times: &[f64],
        initial: Array2<f64>,
        mut state: impl FnMut(usize, &Array1<f64>) -> Array2<f64>,
        stage: Stage,
    ) -> Result<Self> {
        let mut record = Recorder::new(operators, initial, times)?;
        for k in 1..times.len() {
            stage.report(k as f64 / times.len() as f64)?;
            let state = state(k, record.origin());
            let variation = operators.total_variation(state.view());
            let solution = Solution {
                state,
                precision: Precision::Double,
                gap: 0.0,
                tau: times[k] - times[k - 1],
            };
            record.push(solution, variation);
        }
        stage.report(1.0)?;
        Ok(record.finish())
    }
}
