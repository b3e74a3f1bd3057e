//! A deformation that is kept alive: solved, dragged, refined.

use ndarray::Array2;

use crate::deformation::constraints::{Constraints, Targets};
use crate::deformation::outcome::{Deformation, carried};
use crate::deformation::problem::Problem;
use crate::deformation::span::Span;
use crate::discretization::Discretization;
use crate::error::{ArgumentError, Result, has_usable_size, unusable_values};
use crate::memory::needs;
use crate::mesh::TriangleMesh;
use crate::minimization::{PrimalDualNewton, Slope, TangentField, Variation, check_tolerance};
use crate::monitor::{Monitor, Stage};
use crate::operators::total_variation;

/// Shrinkage of the smoothing ε from one iteration to the next, down to its goal.
const CONTINUATION: f64 = 0.2;
/// The first goal of ε, relative to the tolerance times the energy over the area: it costs about half the
/// tolerance.
const GOAL: f64 = 2.5;
/// Where the problem for the present ε is solved to this part of the tolerance and the gap is
/// still above it, the goal is lowered.
const SOLVED: f64 = 0.1;
const MOST_ITERATIONS: usize = 100;
/// ε while dragging, relative to the energy over the area.
const DRAG_EPSILON: f64 = 1e-3;
/// The gap beyond which a drag takes a Newton step too, where that costs no more.
const LAGGING: f64 = 0.02;
/// The mean gradient below which, relative to the displacements over the size, ε does not follow
/// it: with the smaller ε the weights would differ by more than factors can tell apart.
const UNSTRETCHED: f64 = 1e-6;
/// Widths below this, relative to √area, are rounding.
const NO_SOFTNESS: f64 = 1e-12;
/// Progress is shown as nearing the end by this factor an iteration.
const PROGRESS: f64 = 0.87;

/// For refusals.
const SMALLER: &str = "take a mesh of fewer vertices";

/// The displacement of least total variation under constraints whose targets may move.
///
/// The analysis of the systems, the last displacement and its dual field are kept, so that every
/// solution starts from the last one.
///
/// ```
/// use spectral_tv::deformation::{Constraints, Deformer};
///
/// # use spectral_tv::mesh::TriangleMesh;
/// # let vertices = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0.3, 0.3, 1.]];
/// # let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// # let mesh = TriangleMesh::new(vertices, &triangles)?;
/// let constraints = Constraints::new(&mesh, &[0, 1, 3], None)?;
/// let mut deformer = Deformer::new(&mesh, constraints, 0.0)?;
/// let targets = |height: f64| [[0., 0., 0.], [1., 0., 0.], [0.3, 0.3, height]];
/// for height in [1.1, 1.2, 1.3] {
///     deformer.drag(&targets(height))?;
/// }
/// let found = deformer.solve(&targets(1.3), 1e-3)?;
/// assert!(found.gap < 1e-3);
/// # Ok::<(), spectral_tv::Error>(())
/// ```
pub struct Deformer {
    handles: Handles,
    newton: PrimalDualNewton,
    state: Array2<f64>,
    is_at_rest: bool,
}

/// What stays while targets move.
struct Handles {
    operators: Discretization,
    constraints: Constraints,
    softness: f64,
}

impl Handles {
    fn targets(&self, positions: &[[f64; 3]]) -> Result<Targets> {
        let targets = self.constraints.targets(positions)?;
        self.operators.check_gradients(targets.spread())?;
        Ok(targets)
    }

    fn problem<'a>(&'a self, targets: &'a Targets, epsilon: f64) -> Problem<'a> {
        let steepest = match self.softness > NO_SOFTNESS * self.operators.area().sqrt() {
            true => targets.spread() / self.softness,
            false => f64::INFINITY,
        };
        Problem {
            operators: &self.operators,
            targets,
            fixed: &self.constraints.fixed,
            variation: Variation { epsilon, steepest },
        }
    }
}

/// Refuses to deform `mesh` if the `needed` bytes are not available.
///
/// # Errors
/// [`crate::Error::Memory`].
pub(super) fn require(needed: u64, mesh: &TriangleMesh, stage: Stage) -> Result<()> {
    let what = format!("deforming {} vertices", mesh.vertex_count());
    stage.require(needed, &what, SMALLER)
}

impl Deformer {
    /// Prepares `mesh` for deformation. `softness` is the width of the stretched zone, a length;
    /// 0 stretches no more than a ring of triangles.
    ///
    /// # Errors
    /// If softness is negative or not finite, or memory does not suffice.
    pub fn new(mesh: &TriangleMesh, constraints: Constraints, softness: f64) -> Result<Self> {
        Self::new_with(mesh, constraints, softness, Monitor::new().whole())
    }

    /// [`Self::new`], watched: `stage` cancels it.
    ///
    /// # Errors
    /// As [`Self::new`], or [`crate::Error::Cancelled`].
    pub fn new_with(
        mesh: &TriangleMesh,
        constraints: Constraints,
        softness: f64,
        stage: Stage,
    ) -> Result<Self> {
        if !(softness >= 0.0 && has_usable_size(softness)) {
            return Err(ArgumentError::value(
                "softness",
                "must be a length, 0 or more",
                format_args!("{softness:?}"),
            )
            .into());
        }
        require(needs::deformation(needs::Size::of(mesh)), mesh, stage)?;
        let operators = Discretization::new_with(mesh, stage)?;
        Ok(Self {
            newton: PrimalDualNewton::new(&operators, 3, stage)?,
            state: Array2::zeros((3, mesh.vertex_count())),
            is_at_rest: true,
            handles: Handles {
                operators,
                constraints,
                softness,
            },
        })
    }

    /// The last displacement, (3, V), before floating pieces were carried; `None` if there is none
    /// to start from. Another deformer that is given it goes on alike.
    pub fn state(&self) -> Option<&Array2<f64>> {
        (!self.is_at_rest).then_some(&self.state)
    }

    /// Goes on from the state of another deformer of the same mesh and constraints.
    ///
    /// # Errors
    /// If it is not (3, V), or a number is not finite, or beyond 1e100.
    pub fn set_state(&mut self, state: Array2<f64>) -> Result<()> {
        if state.dim() != self.state.dim() || unusable_values(state.view()).is_some() {
            return Err(ArgumentError::contradiction(
                "state",
                &[],
                format!(
                    "the state of a deformer must be finite displacements of its {} vertices",
                    self.state.ncols()
                ),
            )
            .into());
        }
        (self.state, self.is_at_rest) = (state, false);
        Ok(())
    }

    /// The optimum for the target `positions` of the constraints, to a duality gap of `tolerance`
    /// relative to the energy.
    ///
    /// # Errors
    /// As [`Self::drag`]; for a tolerance not in (0, 1).
    pub fn solve(&mut self, positions: &[[f64; 3]], tolerance: f64) -> Result<Deformation> {
        self.solve_with(positions, tolerance, Monitor::new().whole())
    }

    /// [`Self::solve`], watched: `stage` tells how far it is, and cancels it.
    ///
    /// # Errors
    /// As [`Self::solve`]; [`crate::Error::Cancelled`], after which the deformer can go on from
    /// where it was.
    pub fn solve_with(
        &mut self,
        positions: &[[f64; 3]],
        tolerance: f64,
        stage: Stage,
    ) -> Result<Deformation> {
        check_tolerance(tolerance)?;
        self.require(1, stage)?;
        let targets = self.handles.targets(positions)?;
        if targets.radius == 0.0 {
            return Ok(self.carry(&targets));
        }
        let (gap, iterations) = self.within_span(&targets, |deformer, targets| {
            deformer.optimum(targets, tolerance, stage)
        })?;
        stage.report(1.0)?;
        Ok(self.deformation(gap, iterations))
    }

    /// The iteration of [`Self::solve`]; returns the gap and the number of iterations.
    fn optimum(&mut self, targets: &Targets, tolerance: f64, stage: Stage) -> Result<(f64, usize)> {
        let mut goal = GOAL * tolerance;
        let mut smoothing = if self.is_at_rest { 1.0 } else { goal };
        let field = self.follow(targets, stage)?;
        let mut gap = self.gap(targets, 0.0, &field);
        let mut iterations = 1;
        while gap > tolerance && iterations < MOST_ITERATIONS {
            stage.report(1.0 - PROGRESS.powi(iterations as i32))?;
            let epsilon = smoothing * self.gradient_scale(targets);
            let slope = self.iterate(targets, epsilon, stage)?;
            iterations += 1;
            if smoothing > goal {
                smoothing = (CONTINUATION * smoothing).max(goal);
                continue;
            }
            let field = self.balanced_dual(targets, &slope, stage)?;
            gap = self.gap(targets, 0.0, &field);
            if self.gap(targets, epsilon, &field) < SOLVED * tolerance {
                goal *= CONTINUATION;
                smoothing = goal;
            }
        }
        Ok((gap, iterations))
    }

    /// The optima for a sequence of targets, each starting from the one before.
    ///
    /// # Errors
    /// As [`Self::solve`]; [`crate::Error::Memory`] at once if all of them do not fit.
    pub fn solve_sequence(
        &mut self,
        sequence: &[Vec<[f64; 3]>],
        tolerance: f64,
    ) -> Result<Vec<Deformation>> {
        self.solve_sequence_with(sequence, tolerance, Monitor::new().whole())
    }

    /// [`Self::solve_sequence`], watched: `stage` tells how far it is, and cancels it.
    ///
    /// # Errors
    /// As [`Self::solve_sequence`]; [`crate::Error::Cancelled`] as [`Self::solve_with`].
    pub fn solve_sequence_with(
        &mut self,
        sequence: &[Vec<[f64; 3]>],
        tolerance: f64,
        stage: Stage,
    ) -> Result<Vec<Deformation>> {
        self.require(sequence.len(), stage)?;
        let solve = |(index, positions): (usize, &Vec<[f64; 3]>)| {
            let share = stage.part(index, sequence.len());
            self.solve_with(positions, tolerance, share)
        };
        sequence.iter().enumerate().map(solve).collect()
    }

    /// One reweighted solution for new target `positions`, starting from the last one: what there
    /// is time for while a handle is dragged, and a Newton step where a shift has left it behind.
    /// After a small movement it is within some tenths of a percent of the optimum; from rest, or
    /// when handles begin to turn, it takes some calls to get there. The gap tells.
    ///
    /// # Errors
    /// If there are not as many positions as constraints, one is not finite, two exact ones of a
    /// vertex differ, or a system cannot be solved.
    pub fn drag(&mut self, positions: &[[f64; 3]]) -> Result<Deformation> {
        self.drag_with(positions, Monitor::new().whole())
    }

    /// [`Self::drag`], watched: `stage` cancels it.
    ///
    /// # Errors
    /// As [`Self::drag`]; [`crate::Error::Cancelled`], after which the deformer can go on from
    /// where it was.
    pub fn drag_with(&mut self, positions: &[[f64; 3]], stage: Stage) -> Result<Deformation> {
        let needed = needs::solutions(self.size(), 1);
        stage.claim(needed, "following the handles", SMALLER)?;
        let targets = self.handles.targets(positions)?;
        if targets.radius == 0.0 {
            return Ok(self.carry(&targets));
        }
        let gap = self.within_span(&targets, |deformer, targets| {
            let field = deformer.follow(targets, stage)?;
            let mut gap = deformer.gap(targets, 0.0, &field);
            if targets.displacements.nrows() == 1 && gap > LAGGING {
                let epsilon = DRAG_EPSILON * deformer.gradient_scale(targets);
                let slope = deformer.iterate(targets, epsilon, stage)?;
                let field = deformer.balanced_dual(targets, &slope, stage)?;
                gap = deformer.gap(targets, 0.0, &field);
            }
            Ok(gap)
        })?;
        Ok(self.deformation(gap, 1))
    }

    /// Has the work granted what so many solutions take.
    fn require(&self, count: usize, stage: Stage) -> Result<()> {
        let vertices = self.state.ncols();
        let (what, advice) = match count {
            1 => (format!("deforming {vertices} vertices"), SMALLER),
            count => (
                format!("deforming {vertices} vertices {count} times"),
                "take fewer at a time, or a mesh of fewer vertices",
            ),
        };
        stage.require(needs::solutions(self.size(), count), &what, advice)
    }

    fn size(&self) -> needs::Size {
        let faces = self.handles.operators.gradient().face_areas().len();
        needs::Size::new(self.state.ncols(), faces)
    }

    /// Has the state in the coordinates of the span of the targets while `run` is at work.
    fn within_span<T>(
        &mut self,
        targets: &Targets,
        run: impl FnOnce(&mut Self, &Targets) -> Result<T>,
    ) -> Result<T> {
        let constraints = &self.handles.constraints;
        let span = Span::new(targets, |vertex| constraints.is_asked(vertex));
        self.state = span.coordinates(&self.state);
        let result = run(self, &span.reduced(targets));
        self.state = span.displacements(&self.state);
        // What was left out as rounding must not be missing where targets are exact.
        self.handles
            .problem(targets, 0.0)
            .place_fixed(&mut self.state);
        result
    }

    /// Moves the fixed vertices to their targets and solves for the others with the weights of
    /// the last state: L(w) d = 0. At rest w is that of a gradient of the spread over √area
    /// everywhere, which gives the harmonic deformation. Returns
    /// w ∇d, which is free of divergence and so a dual field, but for |z| ≤ 1.
    fn follow(&mut self, targets: &Targets, stage: Stage) -> Result<TangentField> {
        let problem = self
            .handles
            .problem(targets, DRAG_EPSILON * self.gradient_scale(targets));
        let norms = problem
            .operators
            .gradient()
            .norms(&self.state.view().into());
        let weights = match self.is_at_rest {
            true => vec![problem.operators.area().sqrt() / targets.spread(); norms.len()],
            false => problem.variation.weights(&norms),
        };
        let lagged = |_: &[f64]| weights.clone();
        let energy = problem.energy(&lagged);
        problem.place_fixed(&mut self.state);
        let slope = energy.slope(self.state.view());
        let descent = energy.descent(self.state.view(), &slope);
        self.state += &self.newton.reweighted(&energy, &slope, &descent, stage)?;
        let field = energy.slope(self.state.view()).fluxes();
        match self.is_at_rest {
            true => self.newton.forget(targets.displacements.nrows()),
            false => self.newton.set_dual(&energy, &slope, field.clone()),
        }
        self.is_at_rest = false;
        Ok(field)
    }

    /// Moves everything alike, which is as good as rest to start from.
    fn carry(&mut self, targets: &Targets) -> Deformation {
        let deformation = carried(targets);
        self.state.fill(0.0);
        self.is_at_rest = true;
        deformation
    }

    /// One iteration of primal–dual Newton for the smoothing ε; returns the slope it started from.
    fn iterate(&mut self, targets: &Targets, epsilon: f64, stage: Stage) -> Result<Slope> {
        let problem = self.handles.problem(targets, epsilon);
        let weights = |norms: &[f64]| problem.variation.weights(norms);
        let energy = problem.energy(&weights);
        let slope = energy.slope(self.state.view());
        let descent = energy.descent(self.state.view(), &slope);
        let direction = self.newton.direction(&energy, &slope, &descent, stage)?;
        let length = energy.line_search(&slope, &direction, &descent, stage)?;
        self.newton.update_dual(&energy, &slope, &direction);
        self.state.scaled_add(length, &direction);
        Ok(slope)
    }

    /// The dual field of the last iteration, made free of divergence.
    fn balanced_dual(
        &mut self,
        targets: &Targets,
        slope: &Slope,
        stage: Stage,
    ) -> Result<TangentField> {
        let problem = self.handles.problem(targets, 0.0);
        let weights = |norms: &[f64]| problem.variation.weights(norms);
        let energy = problem.energy(&weights);
        self.newton
            .balanced_dual(&energy, slope, &self.state, stage)
    }

    /// Duality gap relative to the energy, TV being smoothed by ε.
    fn gap(&self, targets: &Targets, epsilon: f64, field: &TangentField) -> f64 {
        self.handles
            .problem(targets, epsilon)
            .gap(&self.state, field)
    }

    /// TV(d), length².
    fn total_variation(&self) -> f64 {
        total_variation(self.handles.operators.gradient(), self.state.view())
    }

    /// The energy over the area, against which ε is measured: it costs at most ε A.
    fn gradient_scale(&self, targets: &Targets) -> f64 {
        let area = self.handles.operators.area();
        let energy = self.handles.problem(targets, 0.0).value(&self.state);
        (energy / area).max(UNSTRETCHED * targets.spread() / area.sqrt())
    }

    fn deformation(&self, gap: f64, iterations: usize) -> Deformation {
        let mut displacement = self.state.clone();
        self.handles.constraints.floating.carry(&mut displacement);
        Deformation {
            displacement,
            total_variation: self.total_variation(),
            gap,
            iterations,
        }
    }
}
