//! M3's representation of a shape: a scalar displacement from a smooth base, S = Ŝ + f d̂.

use ndarray::{Array2, ArrayView2, Axis};

use crate::discretization::Discretization;
use crate::error::{ArgumentError, Error, Result, has_usable_size, unusable_values};
use crate::flow::conformal_mean_curvature_flow_with;
use crate::mesh::TriangleMesh;
use crate::method::limbs::keeping_limbs;
use crate::method::outward::outward_signs;
use crate::monitor::Stage;
use crate::named::named;
use crate::operators::positions;
use crate::solver::Solver;

/// How far cMCF flows for the default base, relative to the surface area, and in how many
/// steps: enough to swallow limbs and leave a smooth body.
const BASE_TIME: f64 = 5e-3;
pub(super) const BASE_STEPS: usize = 10;
/// The same for the flow of M1 to the base that keeps limbs, until little of the body's form but its
/// limbs is left.
const LIMBS_TIME: f64 = 3e-3;
/// Distances from the base below this, relative to the shape's size, have no direction.
const COINCIDENT: f64 = 1e-12;

named! {
    /// The metric g₀ of M3's flow. With a flat base a height field is an image, and its flow that of
    /// spectral TV or of spectral ATV (Brokman et al. 2024, Sec. 9.3).
    pub enum Metric: "metric" {
        /// That of the surface S itself: spectral ATV for images.
        #[default]
        Surface = "surface",
        /// That of the base Ŝ: spectral TV for images.
        Base = "base",
    }
}

named! {
    /// What M3 flows of the displacement D = S − Ŝ.
    pub enum Flowing: "displacement" {
        /// Its signed length f along D: the paper's scalar.
        #[default]
        Scalar = "scalar",
        /// D itself, its three channels coupled: no direction is fixed, and no sign needed.
        Vector = "vector",
    }
}

/// The smooth base Ŝ of M3.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Base {
    /// The shape itself under conformalized mean curvature flow.
    #[default]
    ConformalFlow,
    /// M1's low-pass with soft edges and all limbs kept.
    Limbs,
    /// Any shape with the same triangles, (3, V).
    Shape(Array2<f64>),
}

impl Base {
    /// How far the flow to the base goes by default, relative to the area; that of the default base
    /// for a shape that is given.
    pub(super) fn time(&self) -> f64 {
        match self {
            Self::ConformalFlow | Self::Shape(_) => BASE_TIME,
            Self::Limbs => LIMBS_TIME,
        }
    }

    /// Ŝ for `mesh`, (3, V), after a flow of the `duration`, length²; systems are solved by `solver`.
    ///
    /// # Errors
    /// If a given shape has another number of vertices or a coordinate that is not finite; or
    /// as the flow to the base.
    pub(super) fn shape(
        &self,
        mesh: &TriangleMesh,
        operators: &Discretization,
        duration: f64,
        solver: Solver,
        stage: Stage,
    ) -> Result<Array2<f64>> {
        if !(duration > 0.0 && has_usable_size(duration)) {
            return Err(ArgumentError::value(
                "base_time",
                "must be positive and at most 1e100",
                format_args!("{duration:?}"),
            )
            .into());
        }
        match self {
            Self::ConformalFlow => {
                let steps = BASE_STEPS;
                conformal_mean_curvature_flow_with(mesh, operators, duration, steps, solver, stage)
            }
            Self::Limbs => keeping_limbs(mesh, operators, duration, solver, stage),
            Self::Shape(shape) => {
                if shape.dim() != (3, mesh.vertex_count()) {
                    return Err(ArgumentError::count(
                        "base",
                        format!(
                            "must have one position per vertex ({})",
                            mesh.vertex_count()
                        ),
                        shape.ncols(),
                    )
                    .into());
                }
                match unusable_values(shape.view()) {
                    Some((vertices, axis, value)) => Err(Error::NonFiniteBase {
                        vertices,
                        axis,
                        value,
                    }),
                    None => Ok(shape.clone()),
                }
            }
        }
    }
}

/// S = Ŝ + f d̂ (Brokman et al. 2024, Sec. 7.5), or S = Ŝ + D.
#[derive(Debug, Clone)]
pub struct Displacement {
    /// Ŝ, (3, V).
    pub base: Array2<f64>,
    /// d̂, unit vectors that point outwards, (3, V), along which the signed distances f (1, V) are flowed;
    /// `None` where D (3, V) is.
    pub direction: Option<Array2<f64>>,
}

impl Displacement {
    /// Ŝ and D = S − Ŝ, which is to be flowed as a vector.
    pub fn vector(mesh: &TriangleMesh, base: Array2<f64>) -> (Self, Array2<f64>) {
        let values = positions(mesh) - &base;
        let direction = None;
        (Self { base, direction }, values)
    }

    /// Ŝ and d̂, and f: f = α|S − Ŝ| and d̂ = α(S − Ŝ)/|S − Ŝ|, α = ±1 such that d̂ points to the same side as
    /// the normal of Ŝ (see `outward`); the normal itself where S and Ŝ coincide but for rounding,
    /// and there Ŝ is S.
    ///
    /// # Errors
    /// [`crate::Error::Solver`] if the signs cannot be computed, [`crate::Error::Cancelled`].
    pub(super) fn between(
        mesh: &TriangleMesh,
        operators: &Discretization,
        mut base: Array2<f64>,
        solver: Solver,
        stage: Stage,
    ) -> Result<(Self, Array2<f64>)> {
        let normals = stage.pass(|| vertex_normals(base.view(), mesh.triangles()))?;
        let shape = positions(mesh);
        let mut direction = &shape - &base;
        let smallest = COINCIDENT * mesh.area().sqrt();
        let columns = direction.columns_mut().into_iter().enumerate();
        stage.for_each(columns, |(vertex, mut column)| {
            if column.dot(&column).sqrt() <= smallest {
                column.fill(0.0);
                base.column_mut(vertex).assign(&shape.column(vertex));
            }
        })?;
        let signs = outward_signs(operators, direction.view(), normals.view(), solver, stage)?;
        let mut distance = Array2::zeros((1, base.ncols()));
        let columns = direction.columns_mut().into_iter().enumerate();
        stage.for_each(columns, |(vertex, mut column)| {
            let length = column.dot(&column).sqrt();
            if length == 0.0 {
                column.assign(&normals.column(vertex));
                return;
            }
            distance[[0, vertex]] = signs[vertex] * length;
            column.mapv_inplace(|component| signs[vertex] * component / length);
        })?;
        let direction = Some(direction);
        Ok((Self { base, direction }, distance))
    }

    /// The displacement that flowed `values` stand for, (3, V).
    pub fn of(&self, values: Array2<f64>) -> Array2<f64> {
        match &self.direction {
            Some(direction) => direction * &values,
            None => values,
        }
    }
}

/// Area-weighted unit normals of the vertices; 0 for a vertex in no triangle.
fn vertex_normals(shape: ArrayView2<f64>, triangles: &[[u32; 3]]) -> Array2<f64> {
    let mut normals = Array2::<f64>::zeros(shape.dim());
    for corners in triangles {
        let [i, j, k] = corners.map(|corner| corner as usize);
        let p: [f64; 3] = std::array::from_fn(|axis| shape[[axis, j]] - shape[[axis, i]]);
        let q: [f64; 3] = std::array::from_fn(|axis| shape[[axis, k]] - shape[[axis, i]]);
        let normal = [
            p[1] * q[2] - p[2] * q[1],
            p[2] * q[0] - p[0] * q[2],
            p[0] * q[1] - p[1] * q[0],
        ];
        for vertex in [i, j, k] {
            for axis in 0..3 {
                normals[[axis, vertex]] += normal[axis];
            }
        }
    }
    for mut normal in normals.axis_iter_mut(Axis(1)) {
        // Squares of areas of a large shape would leave the range of numbers.
        let largest = normal.fold(0.0_f64, |max, x| max.max(x.abs()));
        if largest > 0.0 {
            normal /= largest;
            let length = normal.dot(&normal).sqrt();
            normal /= length;
        }
    }
    normals
}
