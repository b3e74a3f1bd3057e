//! Gauss–Newton steps of the fine mesh by conjugate gradients, which the coarse mesh and the smoother
//! precondition.

use crate::error::Result;
use crate::monitor::Stage;
use crate::posing::current::Current;
use crate::posing::field::Field;
use crate::posing::levels::Levels;
use crate::posing::linearized::{Linearized, Numbers};
use crate::posing::search::{Reached, largest_movement, limited, searched};

const MOST_ITERATIONS: usize = 60;
/// Of the residual, in the norm of the preconditioner.
const TOLERANCE: f64 = 0.1;
/// An energy that is none, relative to (0.01 D)².
const ROUNDING: f64 = 1e-10;
/// A decrement that makes no step worth its while, relative to the tolerance.
const NOTHING: f64 = 0.01;

impl Current {
    /// A Gauss–Newton step of the fine mesh by preconditioned conjugate gradients. Returns the
    /// decrement of the state it started from, and what it came to.
    pub fn newton(
        &mut self,
        levels: &mut Levels,
        tolerance: f64,
        stage: Stage,
    ) -> Result<(f64, Reached)> {
        let fine = &levels.fine;
        let numbers = self.numbers(fine);
        let linearized = Linearized::of(numbers, fine, &self.state, &self.goals);
        levels.smoother.set_moves(&linearized, stage)?;
        levels.smoother.set_turns(&linearized, stage)?;
        let coarse_state = levels.lift.injected(&self.state);
        let coarse_goals = levels.coarse_goals(&self.goals);
        let coarse_linearized = Linearized::new(&levels.coarse, &coarse_state, &coarse_goals);
        levels.system.factorize(&coarse_linearized, stage)?;
        let (smoother, system) = (&mut levels.smoother, &mut levels.system);
        let (coarse, lift, state) = (&levels.coarse, &levels.lift, &self.state);
        let mut precondition = |residual: &Field| -> Result<Field> {
            let mut found = smoother.solve(residual, stage)?;
            let mut restricted = lift.restrict(residual, &coarse_state, state);
            coarse.reduce(&coarse_state, &mut restricted);
            let mut correction = system.solve(&restricted, coarse);
            coarse.expand(&coarse_state, &mut correction);
            let mut prolonged = lift.prolong(&correction, &coarse_state, state);
            fine.mask(&mut prolonged);
            found.add(1.0, &prolonged);
            Ok(found)
        };
        let value = linearized.numbers.value;
        let mut direction = Field::zeros(fine.rest.len(), fine.body_count);
        let mut residual = linearized.numbers.gradient.clone().reversed();
        let mut preconditioned = precondition(&residual)?;
        let mut search = preconditioned.clone();
        let mut norm = residual.dot(&preconditioned);
        let first = norm;
        let mut iterations = 0;
        while norm > TOLERANCE * TOLERANCE * first && iterations < MOST_ITERATIONS {
            stage.check()?;
            let image = linearized.apply(&search);
            let curvature = search.dot(&image);
            if curvature <= 0.0 {
                break;
            }
            let length = norm / curvature;
            direction.add(length, &search);
            let old = residual.clone();
            residual.add(-length, &image);
            preconditioned = precondition(&residual)?;
            let next = residual.dot(&preconditioned);
            // Of Polak and Ribière, as iterative solves make the preconditioner vary.
            let beta = ((next - old.dot(&preconditioned)) / norm).max(0.0);
            norm = next;
            search.scale_and_add(beta, &preconditioned);
            iterations += 1;
        }
        let slope = linearized.numbers.gradient.dot(&direction);
        let rounding = ROUNDING * fine.parameters.unmoved;
        let decrement = -0.5 * slope / value.max(rounding);
        let stays = Reached {
            movement: 0.0,
            energy: value,
        };
        if decrement <= NOTHING * tolerance {
            self.numbers = Some(linearized.numbers);
            return Ok((decrement.max(0.0), stays));
        }
        let mut expanded = direction.clone();
        fine.expand(&self.state, &mut expanded);
        let (state, goals) = (&self.state, &self.goals);
        let found = searched(limited(&direction), slope, value, |length| {
            let next = fine.moved(state, &expanded, length, goals);
            let numbers = Numbers::new(fine, &next, goals);
            (numbers.value, (next, numbers))
        });
        let Some((next, numbers)) = found else {
            self.numbers = Some(linearized.numbers);
            return Ok((decrement, stays));
        };
        let movement = largest_movement(state, &next);
        let energy = numbers.value;
        (self.state, self.numbers) = (next, Some(numbers));
        Ok((decrement, Reached { movement, energy }))
    }
}
