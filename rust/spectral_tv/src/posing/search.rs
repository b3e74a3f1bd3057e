//! How far to go along a direction.

use crate::parallel;
use crate::posing::field::Field;
use crate::posing::state::State;

/// The largest turn of a step, radians.
const LARGEST_TURN: f64 = 0.7;
/// The part of the decrease that the slope promises which is enough for a step.
const ENOUGH: f64 = 1e-4;
const HALVINGS: usize = 12;

/// The longest step along a direction whose turns are not too large.
pub(super) fn limited(direction: &Field) -> f64 {
    let vertices = parallel::largest(direction.turns.len(), |range| {
        let turns = direction.turns[range].iter();
        turns.map(|turn| turn.norm()).fold(0.0, f64::max)
    });
    let bodies = direction.bodies.iter().map(|turn| turn.norm());
    let largest = bodies.fold(vertices, f64::max);
    match largest > LARGEST_TURN {
        true => LARGEST_TURN / largest,
        false => 1.0,
    }
}

/// What a step of a cycle, or of Newton's method, has come to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reached {
    /// The largest movement of a vertex, length.
    pub movement: f64,
    /// E, length².
    pub energy: f64,
}

/// Halves a step until it decreases the value that `at` gives of its length: what else it gives
/// there; `None` if no step does.
pub(super) fn searched<T>(
    first: f64,
    slope: f64,
    value: f64,
    at: impl Fn(f64) -> (f64, T),
) -> Option<T> {
    let mut length = first;
    let (mut found, mut there) = at(length);
    for _ in 0..HALVINGS {
        if found <= value + ENOUGH * length * slope {
            return Some(there);
        }
        length *= 0.5;
        (found, there) = at(length);
    }
    (found < value).then_some(there)
}

/// The largest movement of a vertex between two states, length.
pub(super) fn largest_movement(before: &State, after: &State) -> f64 {
    parallel::largest(before.positions.len(), |range| {
        let pairs = before.positions[range.clone()]
            .iter()
            .zip(&after.positions[range]);
        pairs.map(|(a, b)| a.metric_distance(b)).fold(0.0, f64::max)
    })
}
