//! Where a pose stands, and cycles of both meshes that take it towards its goals.

use crate::error::Result;
use crate::monitor::Stage;
use crate::posing::field::Field;
use crate::posing::handles::Handles;
use crate::posing::levels::Levels;
use crate::posing::linearized::{Linearized, Numbers};
use crate::posing::model::{Goals, Model};
use crate::posing::motion::Motion;
use crate::posing::search::{Reached, largest_movement, limited, searched};
use crate::posing::state::{State, rotated};

/// Gauss–Newton steps of the coarse mesh in a cycle.
const STEPS: usize = 2;

/// Of the way on from where a cycle has led.
const MOST_DOUBLINGS: usize = 3;

/// A state, the goals that it meets, and the motion that they have in common.
pub(super) struct Current {
    pub state: State,
    pub goals: Goals,
    pub motion: Motion,
    /// The targets that these are of; `None` at rest.
    pub targets: Option<Vec<[f64; 3]>>,
    /// The quadratic model of the fine mesh at this state, if it is known.
    pub numbers: Option<Numbers>,
}

impl Current {
    /// Where all is before anything moves.
    pub fn at_rest(handles: &Handles) -> Self {
        let (state, goals) = handles.at_rest();
        Self {
            state,
            goals,
            motion: Motion::none(),
            targets: None,
            numbers: None,
        }
    }

    /// Takes the quadratic model at this state.
    pub fn numbers(&mut self, fine: &Model) -> Numbers {
        let known = self.numbers.take();
        known.unwrap_or_else(|| Numbers::new(fine, &self.state, &self.goals))
    }

    /// One cycle: the coarse mesh follows the handles, the fine one follows it, and is smoothed.
    pub fn cycle(
        &mut self,
        levels: &mut Levels,
        handles: &Handles,
        targets: &[[f64; 3]],
        stage: Stage,
    ) -> Result<Reached> {
        let (goals, motion) = handles.goals(targets)?;
        let before = levels.lift.injected(&self.state);
        // What the coarse gradient lacks, so that a stationary fine pose stays (Nash 2000, "A
        // multigrid approach to discretized optimization problems").
        let mut lack = {
            let coarse_goals = levels.coarse_goals(&self.goals);
            let fine = self.numbers(&levels.fine);
            let mut asked = levels.lift.restrict(&fine.gradient, &before, &self.state);
            levels.coarse.reduce(&before, &mut asked);
            let coarse = Numbers::new(&levels.coarse, &before, &coarse_goals);
            asked.add(-1.0, &coarse.gradient);
            asked
        };
        let carried = self.motion.to(&motion);
        let mut coarse = before;
        carried.carry(&mut coarse);
        for vectors in [&mut lack.moves, &mut lack.turns, &mut lack.bodies] {
            for vector in vectors.iter_mut() {
                *vector = rotated(&carried.rotation, vector);
            }
        }
        let start = coarse.clone();
        let coarse_goals = levels.coarse_goals(&goals);
        levels.coarse.place(&coarse_goals, &mut coarse);
        for _ in 0..STEPS {
            stage.check()?;
            let linearized = Linearized::new(&levels.coarse, &coarse, &coarse_goals);
            levels.system.factorize(&linearized, stage)?;
            let mut descent = linearized.numbers.gradient.clone();
            descent.add(1.0, &lack);
            let direction = levels.system.solve(&descent, &levels.coarse).reversed();
            let limit = limited(&direction);
            let slope = descent.dot(&direction);
            let mut expanded = direction.clone();
            levels.coarse.expand(&coarse, &mut expanded);
            let value = linearized.numbers.value;
            let along = lack.dot(&direction);
            let (model, goals) = (&levels.coarse, &coarse_goals);
            let state = coarse.clone();
            let found = searched(limit, slope, value, |length| {
                let next = model.moved(&state, &expanded, length, goals);
                let value = model.value(&next, goals) + length * along;
                (value, next)
            });
            let Some(next) = found else {
                break;
            };
            coarse = next;
        }
        let mut origin = self.state.clone();
        carried.carry(&mut origin);
        let mut fine = levels.lift.carry(&origin, &start, &coarse);
        levels.fine.place(&goals, &mut fine);
        let last = std::mem::replace(&mut self.state, fine);
        self.numbers = None;
        (self.goals, self.motion) = (goals, motion);
        let is_resting = self.targets.as_deref() == Some(targets);
        self.targets = Some(targets.to_vec());
        let mut energy = self.smooth(levels, stage)?;
        if is_resting {
            levels.fine.place(&self.goals, &mut origin);
            energy = self.further(levels, &origin, energy);
        }
        Ok(Reached {
            movement: largest_movement(&last, &self.state),
            energy,
        })
    }

    /// Goes on from `origin` through the state for as long as E decreases: a cycle takes away only
    /// a part of what is smooth. Takes and returns E, length².
    fn further(&mut self, levels: &Levels, origin: &State, energy: f64) -> f64 {
        let (fine, goals) = (&levels.fine, &self.goals);
        let start = self.state.clone();
        let direction = start.since(origin);
        let (mut energy, mut length) = (energy, limited(&direction));
        for _ in 0..MOST_DOUBLINGS {
            let next = fine.moved(&start, &direction, length, goals);
            let value = fine.value(&next, goals);
            if value >= energy {
                break;
            }
            (self.state, self.numbers, energy) = (next, None, value);
            length *= 2.0;
        }
        energy
    }

    /// Positions, then rotations, by themselves. Returns E, length².
    fn smooth(&mut self, levels: &mut Levels, stage: Stage) -> Result<f64> {
        let fine = &levels.fine;
        let mut energy = 0.0;
        for is_turning in [false, true] {
            stage.check()?;
            let numbers = self.numbers(fine);
            let (state, goals) = (&self.state, &self.goals);
            let linearized = Linearized::of(numbers, fine, state, goals);
            let mut direction = Field::zeros(fine.rest.len(), fine.body_count);
            let forces = &linearized.numbers.gradient;
            match is_turning {
                false => {
                    levels.smoother.set_moves(&linearized, stage)?;
                    direction.moves = levels.smoother.moves(&forces.moves, stage)?;
                }
                true => {
                    levels.smoother.set_turns(&linearized, stage)?;
                    direction.turns = levels.smoother.turns(&forces.turns, stage)?;
                }
            }
            let direction = direction.reversed();
            let slope = forces.dot(&direction);
            let value = linearized.numbers.value;
            let found = searched(limited(&direction), slope, value, |length| {
                let next = fine.moved(state, &direction, length, goals);
                let numbers = Numbers::new(fine, &next, goals);
                (numbers.value, (next, numbers))
            });
            let numbers = match found {
                Some((next, numbers)) => {
                    self.state = next;
                    numbers
                }
                None => linearized.numbers,
            };
            energy = numbers.value;
            self.numbers = Some(numbers);
        }
        Ok(energy)
    }
}
