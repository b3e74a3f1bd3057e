//! Conjugate gradients, preconditioned by V-cycles, on the functions of all lanes at once.
//!
//! Every lane has step lengths of its own. All lanes stop together, as soon as the sum of their
//! errors is small against the sum of their solutions, both in the energy norm.

use rayon::prelude::*;

use crate::error::Result;
use crate::monitor::Stage;
use crate::parallel;
use crate::solver::multigrid::hierarchy::Hierarchy;
use crate::solver::multigrid::matrix::{Dot, Lanes, chunk_length, sum};
use crate::solver::multigrid::v_cycle::Workspace;

/// The vectors of an iteration.
pub(super) struct Iteration<const L: usize> {
    /// The guess before, the solution after.
    pub solution: Vec<Lanes<L>>,
    /// The right-hand side before, the residual after.
    pub residual: Vec<Lanes<L>>,
    search: Vec<Lanes<L>>,
    /// K p, and in between what a cycle makes of the residual: the one is never needed beside the other.
    image: Vec<Lanes<L>>,
    workspace: Workspace<L>,
}

/// How an iteration went.
#[derive(Debug, Clone, Copy)]
pub(super) struct Report {
    pub has_converged: bool,
    pub iterations: usize,
    /// Factor by which the error fell in one of them, on average.
    pub rate: f64,
}

impl<const L: usize> Iteration<L> {
    /// For systems of this hierarchy.
    pub fn new(hierarchy: &Hierarchy) -> Self {
        let zeros = || parallel::filled([0.0; L], hierarchy.levels[0].matrix.size());
        Self {
            solution: zeros(),
            residual: zeros(),
            search: zeros(),
            image: zeros(),
            workspace: Workspace::new(hierarchy),
        }
    }

    /// Makes room for the levels of a hierarchy that was coarsened anew.
    pub fn adapt(&mut self, hierarchy: &Hierarchy) {
        self.workspace = Workspace::new(hierarchy);
    }

    /// Improves `solution`, which is 0 unless it `has_guess`, until its error is `tolerance` times
    /// itself in the energy norm, or for `most` iterations.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn run(
        &mut self,
        hierarchy: &Hierarchy,
        has_guess: bool,
        tolerance: f64,
        most: usize,
        stage: Stage,
    ) -> Result<Report> {
        let matrix = &hierarchy.levels[0].matrix;
        let mut size = match has_guess {
            true => stage.pass(|| self.start(hierarchy))?,
            false => 0.0,
        };
        let (residual, preconditioned) = (&self.residual, &mut self.image);
        let cycle = || self.workspace.cycle(hierarchy, residual, preconditioned);
        let mut energy = stage.pass(cycle)?;
        self.search.copy_from_slice(&self.image);
        let start = total(energy);
        // Squared errors over those of the iteration before.
        let mut falls = [1.0_f64; 2];
        let mut report = Report {
            has_converged: false,
            iterations: 0,
            rate: 0.0,
        };
        loop {
            let now = total(energy);
            if report.iterations > 0 {
                report.rate = (now / start).powf(0.5 / report.iterations as f64);
            }
            report.has_converged = now <= tolerance * tolerance * size || now == 0.0;
            if report.has_converged || report.iterations == most || !now.is_finite() {
                return Ok(report);
            }
            let curvature = stage.pass(|| matrix.apply(&self.search, &mut self.image))?;
            if (0..L).any(|lane| energy[lane] > 0.0 && curvature[lane] <= 0.0) {
                return Ok(report);
            }
            let lengths = ratios(energy, curvature);
            size += (0..L)
                .map(|lane| f64::from(lengths[lane]) * energy[lane])
                .sum::<f64>();
            stage.pass(|| self.advance(hierarchy, lengths))?;
            report.iterations += 1;
            // The error is known after another cycle only; where it falls as before and that
            // will do, the cycle is spared.
            report.has_converged = now * falls[0].max(falls[1]) <= tolerance * tolerance * size;
            if report.has_converged {
                return Ok(report);
            }
            let (residual, preconditioned) = (&self.residual, &mut self.image);
            let workspace = &mut self.workspace;
            let next =
                stage.pass(|| workspace.finish_cycle(hierarchy, residual, preconditioned))?;
            self.turn(ratios(next, energy));
            falls = [falls[1], total(next) / now];
            energy = next;
        }
    }

    /// r ← b − K x₀; returns |x|² − |x − x₀|² = x₀·(b + r), to which iterations add what they
    /// take from |x − x₀|². A guess that is worse than none is dropped.
    fn start(&mut self, hierarchy: &Hierarchy) -> f64 {
        let chunk = chunk_length(self.solution.len());
        let quadratic = hierarchy.levels[0]
            .matrix
            .apply(&self.solution, &mut self.image);
        let chunks = self
            .solution
            .par_chunks(chunk)
            .zip(self.residual.par_chunks(chunk));
        let linear = chunks.with_max_len(1).map(|(solution, right_hand_side)| {
            let mut dot = Dot::default();
            for (solution, right_hand_side) in solution.iter().zip(right_hand_side) {
                dot.add(solution, right_hand_side);
            }
            dot.finish()
        });
        let linear = sum(&linear.collect::<Vec<_>>());
        let size = 2.0 * total(linear) - total(quadratic);
        if size <= 0.0 || !size.is_finite() {
            self.solution.fill([0.0; L]);
            return 0.0;
        }
        let chunks = self
            .residual
            .par_chunks_mut(chunk)
            .zip(self.image.par_chunks(chunk));
        chunks.with_max_len(1).for_each(|(residual, image)| {
            for (residual, image) in residual.iter_mut().zip(image) {
                for lane in 0..L {
                    residual[lane] -= image[lane];
                }
            }
        });
        size
    }

    /// x ← x + α p, r ← r − α K p, and the next cycle's pre-smoothing of r.
    fn advance(&mut self, hierarchy: &Hierarchy, lengths: Lanes<L>) {
        let finest = &hierarchy.levels[0];
        let chunk = finest.matrix.chunk();
        let solution = self
            .solution
            .par_chunks_mut(chunk)
            .zip(self.search.par_chunks(chunk));
        let residual = self
            .residual
            .par_chunks_mut(chunk)
            .zip(self.image.par_chunks(chunk));
        let smoothed = self.workspace.smoothed().par_chunks_mut(chunk);
        let chunks = solution.zip(residual).zip(smoothed).enumerate();
        chunks.with_max_len(1).for_each(|(part, chunks)| {
            let (((solution, search), (residual, image)), smoothed) = chunks;
            for (solution, search) in solution.iter_mut().zip(search) {
                for lane in 0..L {
                    solution[lane] += lengths[lane] * search[lane];
                }
            }
            for (residual, image) in residual.iter_mut().zip(image) {
                for lane in 0..L {
                    residual[lane] -= lengths[lane] * image[lane];
                }
            }
            let (matrix, first) = (&finest.matrix, part * chunk);
            finest
                .smoother
                .pre_smooth_rows(matrix, first, residual, smoothed);
        });
    }

    /// p ← z + β p.
    fn turn(&mut self, ratios: Lanes<L>) {
        let chunk = chunk_length(self.search.len());
        let chunks = self.search.par_chunks_mut(chunk);
        let chunks = chunks.zip(self.image.par_chunks(chunk)).with_max_len(1);
        chunks.for_each(|(search, preconditioned)| {
            for (search, preconditioned) in search.iter_mut().zip(preconditioned) {
                for lane in 0..L {
                    search[lane] = preconditioned[lane] + ratios[lane] * search[lane];
                }
            }
        });
    }
}

fn total<const L: usize>(lanes: [f64; L]) -> f64 {
    lanes.iter().sum()
}

/// a/b, and 0 where b is: lanes of zeros stay as they are.
fn ratios<const L: usize>(a: [f64; L], b: [f64; L]) -> Lanes<L> {
    std::array::from_fn(|lane| match b[lane] > 0.0 {
        true => (a[lane] / b[lane]) as f32,
        false => 0.0,
    })
}
