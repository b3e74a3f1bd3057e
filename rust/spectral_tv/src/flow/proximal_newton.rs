//! A proximal step of TV by the primal–dual Newton iteration, down to a given gap.

use ndarray::ArrayView2;

use crate::discretization::Discretization;
use crate::error::Result;
use crate::flow::descent::{Descent, Place};
use crate::flow::duality_gap::duality_gap;
use crate::flow::recorder::Solution;
use crate::flow::rigid_parts::RigidParts;
use crate::flow::time_step::TimeStep;
use crate::minimization::PrimalDualNewton;
use crate::monitor::Stage;

/// Factorizations after which a step ends with the gap it has, which is reported.
const MOST_ITERATIONS: usize = 200;
/// Shrinkage of ε from one iteration to the next, while it is above its goal.
const CONTINUATION: f64 = 0.2;

/// Of functions on edges, ε and |∇u| in units of tolerance × mean |∇u|, which is what a smoothing may cost:
/// the least ε, which leaves a third of the gap to Newton's iteration; the ε of an iteration that has
/// only to prove that the state is right; and the gradients up to which parts are rigid.
const LEAST: f64 = 2.5;
const PROVING: f64 = 1.5;
const FLAT: f64 = 10.0;
/// The longest step on edges: what exceeds a Newton direction is out of balance with the dual field.
const LONGEST: f64 = 1.0;
/// The gap after an iteration, in units of the one sought, that tells that the dual field at hand is of no
/// use: ε starts anew.
const LOST: f64 = 100.0;
/// Iterations on the whole mesh before parts are looked for, and after which they are looked for anew; and
/// those of the first step, in which ε comes down from the mean gradient.
const FEW: usize = 2;
const FEW_AT_FIRST: usize = 4;

/// Solves a sequence of proximal steps, each warm-started by the dual of the one before.
pub(super) struct ProximalNewton<'a> {
    operators: &'a Discretization,
    newton: PrimalDualNewton,
    epsilon: f64,
    rigid: Option<RigidParts>,
}

impl<'a> ProximalNewton<'a> {
    /// A solver for functions with `channels` channels.
    pub fn new(operators: &'a Discretization, channels: usize, stage: Stage) -> Result<Self> {
        Ok(Self {
            operators,
            newton: PrimalDualNewton::new(operators, channels, stage)?,
            epsilon: f64::INFINITY,
            rigid: None,
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
        let target = tolerance * step.tau * start;
        if !self.operators.mass().is_lumped() {
            return self.solve_on_edges(step, mean_gradient, goal, target, stage);
        }
        self.epsilon = self.epsilon.min(mean_gradient).max(goal);
        let descent = Descent {
            operators: self.operators,
            step,
            target,
            least: goal,
            shrinkage: |_| CONTINUATION,
            longest: f64::INFINITY,
        };
        let mut place = Place::at_start(step, self.epsilon);
        descent.go_on(&mut self.newton, &mut place, MOST_ITERATIONS, stage)?;
        self.epsilon = place.epsilon;
        Ok(place.best)
    }

    /// The same on edges. Newton's iteration meets more kinks there, and takes several times as many
    /// factorizations. But sets are flat nearly everywhere. So the step is solved with rigid parts first,
    /// which takes little time, and an iteration on the whole mesh proves that it is right or corrects it.
    fn solve_on_edges(
        &mut self,
        step: &TimeStep,
        mean_gradient: f64,
        goal: f64,
        target: f64,
        stage: Stage,
    ) -> Result<Solution> {
        let least = LEAST * goal;
        let is_first = self.epsilon.is_infinite();
        self.epsilon = match is_first {
            true => mean_gradient.max(least),
            false => 2.0 * least,
        };
        let descent = Descent {
            operators: self.operators,
            step,
            target,
            least,
            shrinkage: |_| CONTINUATION,
            longest: LONGEST,
        };
        let mut place = Place::at_start(step, self.epsilon);
        let mut iterations = 0;
        if self.rigid.is_none() {
            let few = if is_first { FEW_AT_FIRST } else { FEW };
            iterations += descent.go_on(&mut self.newton, &mut place, few, stage)?;
            if place.best.gap > target {
                self.find_parts(place.state.view(), goal, stage)?;
            }
        }
        if self.rigid.is_some() && place.best.gap > target {
            self.move_parts(&descent, &mut place, goal, stage)?;
            place.epsilon = PROVING * goal;
            iterations += descent.go_on(&mut self.newton, &mut place, 1, stage)?;
            if place.best.gap > LOST * target {
                place.epsilon = mean_gradient.max(least);
            }
        }
        iterations += descent.go_on(&mut self.newton, &mut place, MOST_ITERATIONS, stage)?;
        if is_first || iterations > FEW {
            self.find_parts(place.best.state.view(), goal, stage)?;
        }
        Ok(place.best)
    }

    fn find_parts(&mut self, state: ArrayView2<f64>, goal: f64, stage: Stage) -> Result<()> {
        self.rigid = RigidParts::of(self.operators, state, FLAT * goal, stage)?;
        Ok(())
    }

    /// Takes the step with rigid parts.
    fn move_parts(
        &mut self,
        descent: &Descent,
        place: &mut Place,
        goal: f64,
        stage: Stage,
    ) -> Result<()> {
        let Some(rigid) = &mut self.rigid else {
            return Ok(());
        };
        let (masses, mut dual) = (self.operators.masses(), self.newton.dual().clone());
        place.state = rigid.solve(descent.step, &mut dual, goal, descent.target, masses, stage)?;
        let state = place.state.view();
        let gap = stage.pass(|| duality_gap(self.operators, descent.step, state, &dual))?;
        self.newton.go_on_from(dual);
        place.keep(gap);
        Ok(())
    }
}
