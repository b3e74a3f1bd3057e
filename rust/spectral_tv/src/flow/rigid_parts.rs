//! A proximal step in which parts where a function is flat move as wholes: few unknowns are left then.

use ndarray::{Array2, ArrayView2};
use petgraph::unionfind::UnionFind;

use crate::discretization::Discretization;
use crate::error::Result;
use crate::flow::descent::{Descent, Place};
use crate::flow::time_step::TimeStep;
use crate::minimization::{PrimalDualNewton, TangentField};
use crate::monitor::Stage;
use crate::operators::SideBySide;

/// Rings of triangles around those that are not flat which may change too.
const RINGS: usize = 3;
/// Parts are of use if no more than this share of the unknowns is left.
const LARGEST_SHARE: f64 = 0.5;
/// Iterations of a step, which are cheap here.
const MOST_ITERATIONS: usize = 20;
/// Gap of a step, and ε at first and in the end, relative to what is sought on the whole mesh.
const GAP: f64 = 0.1;
const FIRST_EPSILON: f64 = 10.0;
const LEAST_EPSILON: f64 = 0.5;
/// Shrinkage of ε from one iteration to the next.
const CONTINUATION: f64 = 0.4;

/// The problem that is left, and its solver.
pub(super) struct RigidParts {
    operators: Discretization,
    newton: PrimalDualNewton,
    /// The part of each unknown, N.
    numbers: Vec<u32>,
    /// Σ m over each part.
    masses: Vec<f64>,
    /// The triangles that are not within a part.
    faces: Vec<u32>,
}

impl RigidParts {
    /// The parts where |∇u| of the unknowns `state` (C, N) is at most `flat`; `None` where too little
    /// is in them.
    ///
    /// # Errors
    /// As [`PrimalDualNewton::new`].
    pub fn of(
        operators: &Discretization,
        state: ArrayView2<f64>,
        flat: f64,
        stage: Stage,
    ) -> Result<Option<Self>> {
        let norms = operators.gradient().norms(&SideBySide::from(state));
        let mut is_free: Vec<bool> = norms.iter().map(|norm| *norm > flat).collect();
        for _ in 0..RINGS {
            stage.pass(|| {
                widen(
                    operators.gradient().triangles(),
                    state.ncols(),
                    &mut is_free,
                )
            })?;
        }
        let (numbers, count) = parts(operators.gradient().triangles(), &is_free, state.ncols());
        let is_worthwhile = count as f64 <= LARGEST_SHARE * state.ncols() as f64;
        let faces = (0..is_free.len() as u32).filter(|&face| is_free[face as usize]);
        let faces: Vec<u32> = faces.collect();
        if !is_worthwhile || faces.is_empty() {
            return Ok(None);
        }
        let operators = operators.with_rigid_parts(&faces, &numbers, count, stage)?;
        Ok(Some(Self {
            newton: PrimalDualNewton::new(&operators, state.nrows(), stage)?,
            masses: operators.masses().to_vec(),
            operators,
            numbers,
            faces,
        }))
    }

    /// Takes `step` as far as it goes with rigid parts, from the `dual` field (C, F) of the whole
    /// mesh. Changes that and returns the unknowns, (C, N). `goal` is the ε and `target` the gap
    /// that are sought on the whole mesh. A step whose unknowns vary within the parts takes their means.
    ///
    /// # Errors
    /// As [`PrimalDualNewton::direction`].
    pub fn solve(
        &mut self,
        step: &TimeStep,
        dual: &mut TangentField,
        goal: f64,
        target: f64,
        masses: &[f64],
        stage: Stage,
    ) -> Result<Array2<f64>> {
        let step = TimeStep {
            data: self.means(&step.data, masses),
            tau: step.tau,
        };
        let chosen = |field: &Vec<_>| {
            self.faces
                .iter()
                .map(|&face| field[face as usize])
                .collect()
        };
        self.newton.go_on_from(dual.iter().map(chosen).collect());
        let descent = Descent {
            operators: &self.operators,
            step: &step,
            target: GAP * target,
            least: LEAST_EPSILON * goal,
            shrinkage: |_| CONTINUATION,
            longest: f64::INFINITY,
        };
        let mut place = Place::at_start(&step, FIRST_EPSILON * goal);
        descent.go_on(&mut self.newton, &mut place, MOST_ITERATIONS, stage)?;
        for (field, solved) in dual.iter_mut().zip(self.newton.dual()) {
            for (&face, vector) in self.faces.iter().zip(solved) {
                field[face as usize] = *vector;
            }
        }
        let size = (place.state.nrows(), self.numbers.len());
        Ok(Array2::from_shape_fn(size, |(channel, unknown)| {
            place.state[[channel, self.numbers[unknown] as usize]]
        }))
    }

    fn means(&self, data: &Array2<f64>, masses: &[f64]) -> Array2<f64> {
        let mut means = Array2::zeros((data.nrows(), self.masses.len()));
        for (row, mut means) in data.rows().into_iter().zip(means.rows_mut()) {
            for ((value, mass), &number) in row.iter().zip(masses).zip(&self.numbers) {
                means[number as usize] += mass * value;
            }
            for (mean, mass) in means.iter_mut().zip(&self.masses) {
                *mean /= mass;
            }
        }
        means
    }
}

/// Frees the triangles that share an unknown with a free one.
fn widen(triangles: &[[u32; 3]], unknowns: usize, is_free: &mut [bool]) {
    let mut touched = vec![false; unknowns];
    for (triangle, _) in triangles.iter().zip(&*is_free).filter(|(_, free)| **free) {
        for &unknown in triangle {
            touched[unknown as usize] = true;
        }
    }
    for (triangle, is_free) in triangles.iter().zip(is_free) {
        *is_free |= triangle.iter().any(|&unknown| touched[unknown as usize]);
    }
}

/// The part of each unknown, and how many there are: the triangles that are not free join theirs.
fn parts(triangles: &[[u32; 3]], is_free: &[bool], unknowns: usize) -> (Vec<u32>, usize) {
    let mut joined = UnionFind::<u32>::new(unknowns);
    for (&[a, b, c], _) in triangles.iter().zip(is_free).filter(|(_, free)| !**free) {
        joined.union(a, b);
        joined.union(b, c);
    }
    let labels = joined.into_labeling();
    let mut numbers = vec![u32::MAX; unknowns];
    let mut count = 0;
    let number = |label: u32| {
        let number = &mut numbers[label as usize];
        if *number == u32::MAX {
            *number = count;
            count += 1;
        }
        *number
    };
    let labels: Vec<u32> = labels.into_iter().map(number).collect();
    (labels, count as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flat_triangles_join_their_unknowns() {
        let triangles = [[0, 1, 2], [2, 3, 4], [4, 5, 6], [7, 8, 0]];
        let mut is_free = [true, false, false, false];
        widen(&triangles, 9, &mut is_free);
        assert_eq!(is_free, [true, true, false, true]);
        let (numbers, count) = parts(&triangles, &is_free, 9);
        assert_eq!((numbers, count), (vec![0, 1, 2, 3, 4, 4, 4, 5, 6], 7));
    }
}
