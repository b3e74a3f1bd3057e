//! Conformalized P-Laplace flows: M2 for P = 3, conformalized mean curvature flow for P = 2.

use std::sync::Arc;

use ndarray::{Array2, ArrayView2};

use crate::discretization::Discretization;
use crate::error::{ArgumentError, Result, has_usable_size};
use crate::flow::law::Law;
use crate::flow::semi_implicit::{Weights, semi_implicit_end};
use crate::flow::times::check_steps;
use crate::memory::needs;
use crate::mesh::{TriangleMesh, barycentric_areas};
use crate::monitor::{Monitor, Stage};
use crate::operators::positions;
use crate::parallel;
use crate::solver::Solver;

/// Past extinction areas vanish and the systems turn singular; these keep them solvable.
/// Relative to the initial shape.
const AREA_FLOOR: f64 = 1e-8;
const WEIGHT_FLOOR: f64 = 1e-4;

/// u_t = √(|g₀|/|g_t|) ∇·(|∇u|^(P−2) ∇u), all in the metric g₀, u the positions (Brokman et
/// al. 2024, Sec. 7.4). Zero-homogeneous for P = 3.
#[derive(Debug, Clone)]
pub struct ConformalLaplace {
    exponent: i32,
    floors: Vec<f64>,
    triangles: Arc<[[u32; 3]]>,
}

impl ConformalLaplace {
    /// The law on the mesh of `operators` for P = `p`, which is 1, 2 or 3.
    ///
    /// # Errors
    /// [`crate::Error::Argument`] for another P.
    pub fn new(operators: &Discretization, p: u32) -> Result<Self> {
        if !(1..=3).contains(&p) {
            return Err(ArgumentError::value("p", "must be 1, 2 or 3", p).into());
        }
        Ok(Self {
            exponent: p as i32 - 2,
            floors: operators
                .masses()
                .iter()
                .map(|mass| AREA_FLOOR * mass)
                .collect(),
            triangles: Arc::clone(operators.gradient().shared_triangles()),
        })
    }
}

impl Law for ConformalLaplace {
    fn weigh(&self, gradient_norms: &mut [f64]) {
        for norm in gradient_norms {
            // The initial norm is √2 on every face, so the floor is relative to it.
            *norm = norm.max(WEIGHT_FLOOR).powi(self.exponent);
        }
    }

    fn is_linear(&self) -> bool {
        self.exponent == 0
    }

    fn moves_masses(&self) -> bool {
        true
    }

    fn masses(&self, values: ArrayView2<f64>) -> Option<Vec<f64>> {
        let face_areas = parallel::map(&self.triangles[..], |&corners| {
            embedded_area(values, corners)
        });
        let mut masses = barycentric_areas(values.ncols(), &self.triangles, &face_areas);
        for (mass, floor) in masses.iter_mut().zip(&self.floors) {
            *mass = mass.max(*floor);
        }
        Some(masses)
    }
}

/// Conformalized mean curvature flow of the mesh (Kazhdan, Solomon, Ben-Chen 2012) for
/// `duration` (length²) in equal steps, neither rescaled nor recentred, its systems solved by
/// `solver`; positions (3, V).
///
/// ```
/// use spectral_tv::discretization::Discretization;
/// use spectral_tv::flow::{Solver, conformal_mean_curvature_flow};
///
/// # use spectral_tv::mesh::TriangleMesh;
/// # let vertices = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0.3, 0.3, 1.]];
/// # let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// # let mesh = TriangleMesh::new(vertices, &triangles)?;
/// let operators = Discretization::new(&mesh)?;
/// let time = 5e-3 * mesh.area();
/// let shape = conformal_mean_curvature_flow(&mesh, &operators, time, 10, Solver::default())?;
/// assert_eq!(shape.dim(), (3, 4));
/// # Ok::<(), spectral_tv::Error>(())
/// ```
///
/// # Errors
/// For a duration that is not positive, no steps, or memory that does not suffice.
pub fn conformal_mean_curvature_flow(
    mesh: &TriangleMesh,
    operators: &Discretization,
    duration: f64,
    steps: usize,
    solver: Solver,
) -> Result<Array2<f64>> {
    let monitor = Monitor::new();
    let stage = monitor.whole();
    conformal_mean_curvature_flow_with(mesh, operators, duration, steps, solver, stage)
}

/// [`conformal_mean_curvature_flow`], watched: `stage` tells how far it is, and cancels it.
///
/// # Errors
/// As [`conformal_mean_curvature_flow`], or [`crate::Error::Cancelled`].
pub fn conformal_mean_curvature_flow_with(
    mesh: &TriangleMesh,
    operators: &Discretization,
    duration: f64,
    steps: usize,
    solver: Solver,
    stage: Stage,
) -> Result<Array2<f64>> {
    if !(duration > 0.0 && has_usable_size(duration)) {
        return Err(ArgumentError::value(
            "duration",
            "must be positive and at most 1e100",
            format_args!("{duration:?}"),
        )
        .into());
    }
    check_steps(steps)?;
    let vertices = mesh.vertex_count();
    stage.require(
        needs::flow(
            needs::Size::of(mesh),
            3,
            steps,
            solver.solved(vertices, Weights::Lagged.demand(3)),
        ),
        &format!("a conformal flow of {steps} steps on {vertices} vertices"),
        "take fewer steps, or a mesh of fewer vertices",
    )?;
    let law = ConformalLaplace::new(operators, 2)?;
    let times: Vec<f64> = (0..=steps)
        .map(|k| duration * k as f64 / steps as f64)
        .collect();
    let initial = positions(mesh);
    let weights = Weights::Lagged;
    semi_implicit_end(operators, &law, weights, initial, &times, solver, stage)
}

/// Area of a triangle whose corners' positions are columns of `positions` (3, V).
fn embedded_area(positions: ArrayView2<f64>, [i, j, k]: [u32; 3]) -> f64 {
    let (i, j, k) = (i as usize, j as usize, k as usize);
    let edge = |to: usize| -> [f64; 3] {
        std::array::from_fn(|axis| positions[[axis, to]] - positions[[axis, i]])
    };
    let (p, q) = (edge(j), edge(k));
    // Squares of squares of coordinates would leave the range of numbers.
    let size = p.iter().chain(&q).fold(0.0_f64, |max, x| max.max(x.abs()));
    if size == 0.0 {
        return 0.0;
    }
    let (p, q) = (p.map(|x| x / size), q.map(|x| x / size));
    let cross = [
        p[1] * q[2] - p[2] * q[1],
        p[2] * q[0] - p[0] * q[2],
        p[0] * q[1] - p[1] * q[0],
    ];
    0.5 * cross.iter().map(|x| x * x).sum::<f64>().sqrt() * size * size
}
