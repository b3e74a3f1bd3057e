//! Collects the trajectory of a running flow.

use std::sync::Arc;

use ndarray::{Array1, Array2, ArrayView2};

use crate::discretization::Discretization;
use crate::error::Result;
use crate::flow::increment::{Increment, Precision};
use crate::flow::origin::{origin_of, without};
use crate::flow::times::check_times;
use crate::flow::trajectory::Trajectory;
use crate::numbering::Numbering;

/// What a step arrived at.
#[derive(Debug, Clone)]
pub(super) struct Solution {
    /// u⁺ (C, V).
    pub state: Array2<f64>,
    /// What its increment is worth.
    pub precision: Precision,
    /// Duality gap of the step's minimisation, absolute.
    pub gap: f64,
    /// The step length τ that the gap is measured against.
    pub tau: f64,
}

/// TV relative to the initial one below which nothing is left to decay.
const EXTINCT: f64 = 1e-9;

/// Increments that the next is extrapolated from. Those before may lose digits that are not worth keeping.
const LATEST: usize = 3;

/// The trajectory so far, and its last state as it was solved for, apart from a constant.
pub(super) struct Recorder {
    /// Its latest increments are numbered as states are.
    trajectory: Trajectory,
    /// How states are numbered, if not as trajectories are.
    numbering: Option<Arc<Numbering>>,
    origin: Array1<f64>,
    state: Array2<f64>,
}

impl Recorder {
    /// Starts at `initial` (C, V). States are values at vertices, by the caller's numbers.
    ///
    /// # Errors
    /// If the times do not increase from 0, or a value is not finite.
    pub fn new(operators: &Discretization, initial: Array2<f64>, times: &[f64]) -> Result<Self> {
        check_times(times)?;
        operators.check_values(initial.view())?;
        let trajectory = Trajectory {
            times: times.to_vec(),
            increments: Vec::with_capacity(times.len() - 1),
            total_variation: vec![operators.total_variation(initial.view())],
            gaps: Vec::new(),
            is_piecewise_linear: false,
            initial,
        };
        let origin = origin_of(trajectory.initial.view());
        Ok(Self {
            state: without(trajectory.initial.clone(), &origin),
            origin,
            numbering: None,
            trajectory,
        })
    }

    /// The same where states are numbered as the unknowns of `operators`, which are at vertices.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of_unknowns(
        operators: &Discretization,
        initial: Array2<f64>,
        times: &[f64],
    ) -> Result<Self> {
        let mut record = Self::new(operators, initial, times)?;
        if let Some(numbering) = operators.numbering() {
            record.state = numbering.inwards(record.state.view());
            record.numbering = Some(Arc::clone(numbering));
        }
        Ok(record)
    }

    /// The constant, (C), that states are recorded apart from.
    pub fn origin(&self) -> &Array1<f64> {
        &self.origin
    }

    /// The last state recorded, (C, V).
    pub fn state(&self) -> ArrayView2<'_, f64> {
        self.state.view()
    }

    /// The increments so far. The latest three are numbered as states are.
    pub fn increments(&self) -> &[Increment] {
        &self.trajectory.increments
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
    pub fn push(&mut self, solution: Solution, total_variation: f64) {
        let fall = solution.tau * self.last_total_variation();
        // Steps and variations may be so small that their product is 0.
        let gap = match self.is_extinct() || fall == 0.0 {
            true => 0.0,
            false => solution.gap / fall,
        };
        self.trajectory.total_variation.push(total_variation);
        self.trajectory.gaps.push(gap);
        let previous = std::mem::replace(&mut self.state, solution.state);
        let (before, now) = (previous.view(), self.state.view());
        let is_short = solution.precision == Precision::Short;
        let precision = match is_short {
            true => Precision::Single,
            false => solution.precision,
        };
        let increment = Increment::between(before, now, precision);
        let increments = &mut self.trajectory.increments;
        increments.push(increment);
        let earlier = increments.len().checked_sub(LATEST + 1);
        if let Some(earlier) = earlier.and_then(|place| increments.get_mut(place)) {
            if let Some(numbering) = &self.numbering {
                earlier.renumber(numbering);
            }
            if is_short {
                earlier.shorten();
            }
        }
    }

    /// The last state, (C, V), with all its digits.
    pub fn end(self) -> Array2<f64> {
        let mut state = match &self.numbering {
            Some(numbering) => numbering.outwards(self.state.view()),
            None => self.state,
        };
        for (mut channel, &origin) in state.rows_mut().into_iter().zip(&self.origin) {
            channel += origin;
        }
        state
    }

    /// The finished trajectory.
    pub fn finish(mut self) -> Trajectory {
        if let Some(numbering) = &self.numbering {
            let increments = &mut self.trajectory.increments;
            let latest = increments.len().saturating_sub(LATEST);
            for increment in &mut increments[latest..] {
                increment.renumber(numbering);
            }
        }
        self.trajectory
    }
}
