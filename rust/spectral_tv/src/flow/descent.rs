//! The iteration of a proximal step of TV: Newton directions while ε shrinks, down to a given gap.

use ndarray::Array2;

use crate::discretization::Discretization;
use crate::error::Result;
use crate::flow::duality_gap::duality_gap;
use crate::flow::increment::Precision;
use crate::flow::recorder::Solution;
use crate::flow::time_step::TimeStep;
use crate::minimization::{Energy, PrimalDualNewton, Variation};
use crate::monitor::Stage;

/// min ½‖u − û‖²_H + τ TV(u), and when to be content.
pub(super) struct Descent<'a> {
    pub operators: &'a Discretization,
    pub step: &'a TimeStep,
    /// The gap to be reached.
    pub target: f64,
    /// The least ε.
    pub least: f64,
    /// By what ε is multiplied from one iteration to the next, given ε.
    pub shrinkage: fn(f64) -> f64,
    /// The longest step, in Newton directions.
    pub longest: f64,
}

/// Where a descent is.
pub(super) struct Place {
    pub state: Array2<f64>,
    /// The ε of the next iteration.
    pub epsilon: f64,
    /// The best of the states so far, with its gap.
    pub best: Solution,
}

impl Place {
    /// At the start of a step, with a gap that is not known.
    pub fn at_start(step: &TimeStep, epsilon: f64) -> Self {
        Self {
            state: step.data.clone(),
            epsilon,
            best: Solution {
                state: step.data.clone(),
                precision: Precision::Double,
                gap: f64::INFINITY,
                tau: step.tau,
            },
        }
    }

    /// Keeps the state, if its `gap` is the least so far.
    pub fn keep(&mut self, gap: f64) {
        if gap < self.best.gap {
            self.best.gap = gap;
            self.best.state.assign(&self.state);
        }
    }
}

impl Descent<'_> {
    /// Goes on from `place`, with the dual field of `newton`, by up to `most` iterations. Returns how many
    /// it took.
    ///
    /// # Errors
    /// As [`PrimalDualNewton::direction`].
    pub fn go_on(
        &self,
        newton: &mut PrimalDualNewton,
        place: &mut Place,
        most: usize,
        stage: Stage,
    ) -> Result<usize> {
        let (operators, step) = (self.operators, self.step);
        if place.best.gap <= self.target {
            return Ok(0);
        }
        for iteration in 0..most {
            let variation = Variation::smoothed(place.epsilon);
            let energy = Energy {
                operators,
                weights: &|norms| variation.weights(norms),
                least_weight: 0.0,
                mass: operators.mass(),
                data: &step.data,
                tau: step.tau,
                fixed: &[],
            };
            let slope = stage.pass(|| energy.slope(place.state.view()))?;
            let descent = stage.pass(|| energy.descent(place.state.view(), &slope))?;
            let direction = newton.direction(&energy, &slope, &descent, stage)?;
            let length = energy.line_search(&slope, &direction, &descent, stage)?;
            let length = length.min(self.longest);
            stage.pass(|| newton.update_dual(&energy, &slope, &direction))?;
            place.state.scaled_add(length, &direction);
            let (state, dual) = (place.state.view(), newton.dual());
            let gap = stage.pass(|| duality_gap(operators, step, state, dual))?;
            place.keep(gap);
            if place.best.gap <= self.target {
                return Ok(iteration + 1);
            }
            place.epsilon = ((self.shrinkage)(place.epsilon) * place.epsilon).max(self.least);
        }
        Ok(most)
    }
}
