//! Steps of total variation of a single function by the primal–dual Newton method, see [`crate::minimization`].
//!
//! Where regions merge, the velocity jumps, and weights that are predicted or corrected by a matrix without
//! directions lag far behind. The dual field z tells in advance where. It is carried from step to step. So
//! two iterations are enough at the final ε: a third changes bands by less than a tenth of their error.

use ndarray::{Array2, Zip};
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::flow::line::Line;
use crate::flow::step_system::StepSystem;
use crate::flow::time_step::TimeStep;
use crate::minimization::least_along;
use crate::operators::{Corners, FaceVector, element_stiffness, inner_product, squared_norm};
use crate::parallel;

/// Most iterations of a step. There are at least two: one leaves several times the error.
const MOST_ITERATIONS: usize = 8;
/// Size of a direction, relative to the first and both in the energy norm, beyond which another follows. The
/// second is 0.1 to 0.4 on most shapes. From functions with jumps, flat nearly everywhere, it may be more.
const LARGE: f64 = 0.5;
/// Error of a direction that an iterative solver leaves, relative to the direction.
const TOLERANCE: f64 = 1e-5;

/// The dual field of a flow of one channel.
pub(super) struct DualSteps {
    /// z, |z| ≤ 1 on every face.
    dual: Vec<FaceVector>,
    corners: Corners,
}

/// Where iterations have got to.
struct Iterate {
    /// u, (1, V).
    state: Array2<f64>,
    /// ∇u on every face.
    slopes: Vec<FaceVector>,
}

/// The end of a step.
pub(super) struct DualStep {
    /// u⁺, (1, V).
    pub state: Array2<f64>,
    /// |∇u⁺| on every face.
    pub norms: Vec<f64>,
    /// Primal minus dual energy for the dual field z.
    pub gap: f64,
}

impl DualSteps {
    /// Starts with the dual field 0.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub fn new(system: &StepSystem) -> Result<Self> {
        let gradient = system.operators.gradient();
        Ok(Self {
            dual: vec![[0.0; 2]; gradient.face_areas().len()],
            corners: Corners::new(gradient, system.stage)?,
        })
    }

    /// The minimum of ½‖u − û‖²_M + τ TV(u), nearly, from û.
    ///
    /// # Errors
    /// [`Error::Cancelled`], or [`Error::Solver`] if a matrix is far from positive definite.
    pub fn solve(&mut self, system: &mut StepSystem, step: &TimeStep) -> Result<DualStep> {
        let (stage, gradient) = (system.stage, system.operators.gradient());
        let mut at = Iterate {
            slopes: stage.pass(|| gradient.vectors(&step.data.view().into()))?,
            state: step.data.clone(),
        };
        let first = self.iterate(system, step, &mut at)?;
        for _ in 1..MOST_ITERATIONS {
            let square = self.iterate(system, step, &mut at)?;
            if square <= LARGE * LARGE * first {
                break;
            }
        }
        let norms = stage.pass(|| norms_of(&at.slopes))?;
        Ok(DualStep {
            gap: self.gap(system, step, &at, &norms)?,
            state: at.state,
            norms,
        })
    }

    /// One Newton step; returns the squared norm of its direction.
    fn iterate(
        &mut self,
        system: &mut StepSystem,
        step: &TimeStep,
        at: &mut Iterate,
    ) -> Result<f64> {
        let (stage, law, operators) = (system.stage, system.law, system.operators);
        let (gradient, masses) = (operators.gradient(), operators.masses());
        let norms = stage.pass(|| norms_of(&at.slopes))?;
        let weights = stage.pass(|| law.weights(&norms))?;
        self.set_matrix(system, step, &at.slopes, &weights)?;
        let descent = self.residual(system, step, at, |face| {
            at.slopes[face].map(|slope| weights[face] * slope)
        })?;
        let both = (step, masses);
        let direction = system.increment(&descent, both, at.state.view(), None, TOLERANCE)?;
        let start = stage.pass(|| -inner_product(descent.view(), direction.view()))?;
        drop(descent);
        let changes = stage.pass(|| gradient.vectors(&direction.view().into()))?;
        let products =
            |([g, h], [d, e]): (&FaceVector, &FaceVector)| [g * d + h * e, d * d + e * e];
        let pairs = at.slopes.par_iter().zip(&changes);
        let products = stage.pass(|| parallel::map(pairs, products))?;
        stage.pass(|| self.update(&at.slopes, &changes, &weights, &products))?;
        let line = Line::of_products(law, gradient.face_areas(), norms, products);
        let quadratic = stage.pass(|| squared_norm(direction.view(), masses))?;
        let linear = start - step.tau * stage.pass(|| line.slope_at_start(&weights))?;
        let slope = |alpha: f64| linear + alpha * quadratic + step.tau * line.slope(alpha);
        let length = stage.pass(|| least_along(start, slope))?;
        let advance = |value: &mut f64, direction: &f64| *value += length * direction;
        let state = &mut at.state;
        stage.pass(|| Zip::from(state).and(&direction).par_for_each(advance))?;
        let faces = at.slopes.par_iter_mut().zip(&changes);
        let advance = |([g, h], [d, e]): (&mut FaceVector, &FaceVector)| {
            *g += length * d;
            *h += length * e;
        };
        stage.pass(|| parallel::for_each(faces, advance))?;
        Ok(-start)
    }

    /// Takes M + τ Gᵀ A H G, H = w (I − ½ w (z gᵀ + g zᵀ)), for the gradients g = `slopes` and their weights w.
    fn set_matrix(
        &self,
        system: &mut StepSystem,
        step: &TimeStep,
        slopes: &[FaceVector],
        weights: &[f64],
    ) -> Result<()> {
        let (stage, operators) = (system.stage, system.operators);
        let (masses, tau) = (operators.masses(), step.tau);
        let couplings = stage.pass(|| {
            let share = |face| self.share(system, face, slopes[face], weights[face]);
            operators
                .edges()
                .couplings_of(&parallel::values(slopes.len(), share))
        })?;
        match system.solver.set_matrix(masses, couplings, tau, stage) {
            // H may be singular but for rounding, on needles. Without directions it is not.
            Err(Error::Solver(_)) => {
                let couplings =
                    stage.pass(|| operators.edges().couplings(operators.gradient(), weights))?;
                system.solver.set_matrix(masses, couplings, tau, stage)
            }
            outcome => outcome,
        }
    }

    /// What a face has in the couplings of its edges.
    #[inline(always)]
    fn share(&self, system: &StepSystem, face: usize, g: FaceVector, weight: f64) -> [f64; 3] {
        let gradient = system.operators.gradient();
        let (hats, area) = (&gradient.hats(face), gradient.face_areas()[face]);
        let along = |v: FaceVector| hats.map(|hat| hat[0] * v[0] + hat[1] * v[1]);
        let (z, g) = (along(self.dual[face]), along(g));
        let half = 0.5 * area * weight;
        let mut shares = element_stiffness(hats, area);
        for (share, (p, q)) in shares.iter_mut().zip([(1, 2), (2, 0), (0, 1)]) {
            *share = weight * (half * (z[p] * g[q] + g[p] * z[q]) - *share);
        }
        shares
    }

    /// M (û − u) − τ Gᵀ A z, (1, V), for a field z.
    fn residual(
        &self,
        system: &StepSystem,
        step: &TimeStep,
        at: &Iterate,
        field: impl Fn(usize) -> FaceVector + Sync + Send,
    ) -> Result<Array2<f64>> {
        let (stage, gradient) = (system.stage, system.operators.gradient());
        let flux = |face| gradient.flux(face, field(face));
        let fluxes = stage.pass(|| parallel::values(self.dual.len(), flux))?;
        let (data, state) = (step.data.row(0), at.state.row(0));
        let masses = system.operators.masses();
        let residual = |vertex: usize| {
            let off = masses[vertex] * (data[vertex] - state[vertex]);
            off - step.tau * self.corners.sum_at(vertex, &fluxes)
        };
        let residual = stage.pass(|| parallel::values(masses.len(), residual))?;
        Ok(Array2::from_shape_vec((1, masses.len()), residual).expect("one row"))
    }

    /// z ← w (∇u + ∇δ − w ⟨∇u, ∇δ⟩ z), clipped to |z| ≤ 1.
    fn update(
        &mut self,
        slopes: &[FaceVector],
        changes: &[FaceVector],
        weights: &[f64],
        products: &[[f64; 2]],
    ) {
        let faces = self.dual.par_iter_mut().zip(slopes).zip(changes);
        let faces = faces.zip(weights).zip(products);
        parallel::for_each(faces, |((((z, g), d), weight), [along, _])| {
            let turned = [0, 1].map(|i| weight * (g[i] + d[i] - weight * along * z[i]));
            let [x, y] = turned;
            let clip = (x * x + y * y).sqrt().max(1.0).recip();
            *z = turned.map(|component| clip * component);
        });
    }

    /// Primal minus dual energy of min ½‖u − û‖²_M + τ TV(u), for the dual field z. A sum of non-negative
    /// terms, so that it loses no digits.
    fn gap(
        &self,
        system: &StepSystem,
        step: &TimeStep,
        at: &Iterate,
        norms: &[f64],
    ) -> Result<f64> {
        let (stage, masses) = (system.stage, system.operators.masses());
        let areas = system.operators.gradient().face_areas();
        let residual = self.residual(system, step, at, |face| self.dual[face])?;
        let distance = |vertices: std::ops::Range<usize>| -> f64 {
            let own = masses[vertices.clone()].iter();
            let residual = parallel::columns(residual.view(), vertices);
            own.zip(residual).map(|(m, r)| 0.5 * r * r / m).sum()
        };
        let excess = |faces: std::ops::Range<usize>| -> f64 {
            let excess = faces.map(|face| {
                let ([g, h], [x, y]) = (at.slopes[face], self.dual[face]);
                areas[face] * (norms[face] - g * x - h * y).max(0.0)
            });
            excess.sum()
        };
        let distance = stage.pass(|| parallel::sum(masses.len(), distance))?;
        Ok(distance + step.tau * stage.pass(|| parallel::sum(areas.len(), excess))?)
    }
}

fn norms_of(slopes: &[FaceVector]) -> Vec<f64> {
    parallel::map(slopes, |[x, y]| (x * x + y * y).sqrt())
}
