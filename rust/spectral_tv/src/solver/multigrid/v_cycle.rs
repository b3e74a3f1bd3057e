//! One symmetric V-cycle: pre-smooth, restrict the residual, correct by the next level,
//! post-smooth.

use crate::parallel;
use crate::solver::multigrid::hierarchy::Hierarchy;
use crate::solver::multigrid::matrix::{Dot, Lanes};

/// The vectors of one level that a cycle works in.
struct Vectors<const L: usize> {
    smoothed: Vec<Lanes<L>>,
    /// Right-hand side and solution of the next level.
    coarse: (Vec<Lanes<L>>, Vec<Lanes<L>>),
}

/// Everything that cycles of `L` functions at once write to.
pub(super) struct Workspace<const L: usize> {
    levels: Vec<Vectors<L>>,
}

impl<const L: usize> Workspace<L> {
    /// For this hierarchy.
    pub fn new(hierarchy: &Hierarchy) -> Self {
        let zeros = |size: usize| parallel::filled([0.0; L], size);
        let sizes = hierarchy.levels.iter().map(|level| level.matrix.size());
        let next = sizes.clone().skip(1).chain([0]);
        let levels = sizes.zip(next).map(|(size, next)| Vectors {
            smoothed: zeros(size),
            coarse: (zeros(next), zeros(next)),
        });
        Self {
            levels: levels.collect(),
        }
    }

    /// What a cycle pre-smooths on the finest level, for callers that do so by themselves as soon
    /// as parts of the right-hand side are known.
    pub fn smoothed(&mut self) -> &mut [Lanes<L>] {
        &mut self.levels[0].smoothed
    }

    /// `solution` ← B b, where B ≈ K⁻¹ is the cycle; returns b·B b of every lane.
    pub fn cycle(
        &mut self,
        hierarchy: &Hierarchy,
        right_hand_side: &[Lanes<L>],
        solution: &mut [Lanes<L>],
    ) -> [f64; L] {
        pre_smooth(hierarchy, 0, &mut self.levels, right_hand_side);
        self.finish_cycle(hierarchy, right_hand_side, solution)
    }

    /// [`Self::cycle`] after pre-smoothing on the finest level.
    pub fn finish_cycle(
        &mut self,
        hierarchy: &Hierarchy,
        right_hand_side: &[Lanes<L>],
        solution: &mut [Lanes<L>],
    ) -> [f64; L] {
        finish(hierarchy, 0, &mut self.levels, right_hand_side, solution)
    }
}

/// Pre-smooths on a level.
fn pre_smooth<const L: usize>(
    hierarchy: &Hierarchy,
    index: usize,
    vectors: &mut [Vectors<L>],
    right_hand_side: &[Lanes<L>],
) {
    let level = &hierarchy.levels[index];
    let smoothed = &mut vectors[0].smoothed;
    level
        .smoother
        .pre_smooth(&level.matrix, right_hand_side, smoothed);
}

/// What follows pre-smoothing on a level: restrict, correct, post-smooth.
fn finish<const L: usize>(
    hierarchy: &Hierarchy,
    index: usize,
    vectors: &mut [Vectors<L>],
    right_hand_side: &[Lanes<L>],
    solution: &mut [Lanes<L>],
) -> [f64; L] {
    let level = &hierarchy.levels[index];
    let (matrix, smoother) = (&level.matrix, &level.smoother);
    let (own, below) = vectors.split_first_mut().expect("one for every level");
    let Some(coarsening) = &level.coarsening else {
        if let Some(coarsest) = &hierarchy.coarsest {
            coarsest.solve(right_hand_side, solution);
            let mut dot = Dot::default();
            for (a, b) in right_hand_side.iter().zip(solution.iter()) {
                dot.add(a, b);
            }
            return dot.finish();
        }
        return smoother.post_smooth(matrix, right_hand_side, &own.smoothed, None, solution);
    };
    // The residual is restricted before the solution takes its place.
    matrix.residual(right_hand_side, &own.smoothed, solution);
    let prolongation = &coarsening.prolongation;
    let (coarse_right, correction) = &mut own.coarse;
    prolongation.restrict(solution, coarse_right);
    pre_smooth(hierarchy, index + 1, below, coarse_right);
    finish(hierarchy, index + 1, below, coarse_right, correction);
    let coarse = Some((prolongation, &correction[..]));
    smoother.post_smooth(matrix, right_hand_side, &own.smoothed, coarse, solution)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::multigrid::examples::{dot, hierarchy_of, irregular, lattice, random};

    #[test]
    fn a_cycle_is_symmetric_and_positive() {
        for (lower, masses) in [lattice(110, 90, 1e-4), irregular(3000)] {
            let hierarchy = hierarchy_of(&lower, &masses);
            let size = masses.len();
            let mut workspace = Workspace::<1>::new(&hierarchy);
            let (a, b) = (random::<1>(size, 6), random::<1>(size, 7));
            let (mut image_a, mut image_b) = (a.clone(), b.clone());
            let energy = workspace.cycle(&hierarchy, &a, &mut image_a)[0];
            workspace.cycle(&hierarchy, &b, &mut image_b);
            assert!(energy > 0.0);
            assert!((energy - dot(&a, &image_a)).abs() < 1e-6 * energy);
            assert!((dot(&a, &image_b) - dot(&image_a, &b)).abs() < 1e-4 * energy);
        }
    }
}
