//! A proximal step of TV by the primal–dual Newton iteration, down to a given gap.

use ndarray::Array2;

use crate::discretization::Discretization;
use crate::error::Result;
use crate::flow::duality_gap::duality_gap;
use crate::flow::increment::Precision;
use crate::flow::recorder::Solution;
use crate::flow::time_step::TimeStep;
use crate::minimization::{Energy, PrimalDualNewton, Variation};
use crate::monitor::Stage;

/// Factorizations after which a step ends with the gap it has, which is reported.
const MOST_ITERATIONS: usize = 200;
/// Shrinkage of ε from one iteration to the next, while it is above its goal.
const CONTINUATION: f64 = 0.2;

/// Solves a sequence of proximal steps, each warm-started by the dual of the one before.
pub(super) struct ProximalNewton<'a> {
    operators: &'a Discretization,
    newton: PrimalDualNewton,
    epsilon: f64,
    /// What the last step changed by its length, where states are guessed by it.
    velocity: Option<Array2<f64>>,
}

impl<'a> ProximalNewton<'a> {
    /// A solver for functions with `channels` channels.
    pub fn new(operators: &'a Discretization, channels: usize, stage: Stage) -> Result<Self> {
        Ok(Self {
            operators,
            newton: PrimalDualNewton::new(operators, channels, stage)?,
            epsilon: f64::INFINITY,
            velocity: None,
        })
    }

    /// argmin ½‖u − û‖²_H + τ TV(u), to a gap of `tolerance` relative to τ `start`, the TV at
    /// the start of the step.
    pub fn solve(
        &mut self,
        step: &TimeStep,
        start: f64,
        tolerance: f64,
        stage: Stage,
    ) -> Result<Solution> {
        let mean_gradient = start / self.operators.area();
        // Smoothing costs at most about 0.3 ε a unit of area, so this much is affordable.
        let goal = tolerance * mean_gradient;
        self.epsilon = self.epsilon.min(mean_gradient).max(goal);
        let target = tolerance * step.tau * start;
        let mut best = Solution {
            state: step.data.clone(),
            precision: Precision::Double,
            gap: f64::INFINITY,
            tau: step.tau,
        };
        let mut state = self.guess(step, &mut best, stage)?;
        let most = if best.gap <= target {
            0
        } else {
            MOST_ITERATIONS
        };
        for _ in 0..most {
            let variation = Variation::smoothed(self.epsilon);
            let energy = Energy {
                operators: self.operators,
                weights: &|norms| variation.weights(norms),
                least_weight: 0.0,
                mass: self.operators.mass(),
                data: &step.data,
                tau: step.tau,
                fixed: &[],
            };
            let slope = stage.pass(|| energy.slope(state.view()))?;
            let descent = stage.pass(|| energy.descent(state.view(), &slope))?;
            let direction = self.newton.direction(&energy, &slope, &descent, stage)?;
            let length = energy.line_search(&slope, &direction, &descent, stage)?;
            stage.pass(|| self.newton.update_dual(&energy, &slope, &direction))?;
            state.scaled_add(length, &direction);
            let dual = self.newton.dual();
            let gap = stage.pass(|| duality_gap(self.operators, step, state.view(), dual))?;
            if gap < best.gap {
                best.gap = gap;
                best.state.assign(&state);
            }
            if best.gap <= target {
                break;
            }
            self.epsilon = (CONTINUATION * self.epsilon).max(goal);
        }
        if !self.operators.mass().is_lumped() {
            let mut velocity = &best.state - &step.data;
            velocity /= step.tau;
            self.velocity = Some(velocity);
        }
        Ok(best)
    }

    /// A state to start from, and the best of those that were tried. On edges a state that goes on as
    /// the last step did costs nothing, and is nearly the solution while a set fades.
    fn guess(&self, step: &TimeStep, best: &mut Solution, stage: Stage) -> Result<Array2<f64>> {
        let Some(velocity) = &self.velocity else {
            return Ok(step.data.clone());
        };
        let mut ahead = step.data.clone();
        ahead.scaled_add(step.tau, velocity);
        let (operators, dual) = (self.operators, self.newton.dual());
        let gap = |state: &Array2<f64>| duality_gap(operators, step, state.view(), dual);
        let [at_rest, going_on] = stage.pass(|| [&step.data, &ahead].map(gap))?;
        if going_on > at_rest {
            return Ok(step.data.clone());
        }
        best.gap = going_on;
        best.state.assign(&ahead);
        Ok(ahead)
    }
}
