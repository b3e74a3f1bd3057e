//! The shape and the constraints of a deformation, and the function that starts one.

use std::sync::Arc;

use pyo3::prelude::*;
use spectral_tv::deformation::{self, Algorithm, Constraints, Settings, deform_with};
use spectral_tv::memory::needs;
use spectral_tv::mesh::TriangleMesh;
use spectral_tv::monitor::Stage;

use crate::arrays::{self, Vertices};
use crate::error::Failure;
use crate::job::{Job, guarded};
use crate::mesh::Mesh;
use crate::parameters;
use crate::results::Fields;
use crate::settings::named;

/// What turns a displacement into a deformed shape.
pub struct Shape {
    mesh: Arc<TriangleMesh>,
    unconstrained: Arc<Vec<i64>>,
}

impl Shape {
    pub fn new(mesh: &Mesh, constraints: &Constraints) -> Self {
        let floating = constraints.floating().iter().enumerate();
        Self {
            mesh: Arc::clone(&mesh.inner),
            unconstrained: Arc::new(
                floating
                    .filter_map(|(vertex, &floating)| floating.then_some(vertex as i64))
                    .collect(),
            ),
        }
    }

    /// The result of the package.
    pub fn deformed<'py>(
        &self,
        py: Python<'py>,
        solution: deformation::Deformation,
    ) -> Result<Bound<'py, PyAny>, Failure> {
        let mut vertices = solution.displacement;
        for (mut vertex, rest) in vertices.columns_mut().into_iter().zip(self.mesh.vertices()) {
            for (axis, rest) in rest.iter().enumerate() {
                vertex[axis] += rest;
            }
        }
        let fields = Fields::new(py)
            .with("vertices", arrays::per_vertex(py, vertices.view())?)?
            .with("total_variation", solution.total_variation)?
            .with("gap", solution.gap)?
            .with("iterations", solution.iterations)?
            .with("unconstrained", arrays::array_of(py, &self.unconstrained)?)?;
        Ok(fields.made("Deformation")?)
    }
}

/// What is constrained, as it came from Python, and how firmly.
#[derive(Clone)]
pub struct Handles {
    pub indices: Vec<i64>,
    pub weights: Option<Vec<f64>>,
}

impl Handles {
    pub fn new(
        mesh: &Mesh,
        indices: &Bound<'_, PyAny>,
        weights: Option<&Bound<'_, PyAny>>,
    ) -> Result<Self, Failure> {
        let indices = match arrays::vertices("indices", indices, mesh.inner.vertex_count())? {
            Vertices::Indices(indices) => indices,
            Vertices::Mask(mask) => {
                let places = (0_i64..).zip(&mask);
                places
                    .filter_map(|(place, &is_meant)| is_meant.then_some(place))
                    .collect()
            }
        };
        let weights = match weights {
            Some(weights) => Some(arrays::list("weights", weights)?),
            None => None,
        };
        Ok(Self { indices, weights })
    }

    pub fn constraints(&self, py: Python<'_>, mesh: &Mesh) -> Result<Constraints, Failure> {
        let mesh = &mesh.inner;
        guarded(py, |stage| {
            let needed = needs::solutions(needs::Size::of(mesh), 0);
            stage.claim(
                needed,
                "finding what is held",
                "take a mesh of fewer vertices",
            )?;
            Constraints::new(mesh, &self.indices, self.weights.as_deref())
        })
    }
}

#[pyfunction]
pub fn start_deform(
    mesh: &Mesh,
    indices: &Bound<'_, PyAny>,
    targets: &Bound<'_, PyAny>,
    weights: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = parameters::softness)] softness: f64,
    #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
    #[pyo3(from_py_with = named)] algorithm: Algorithm,
) -> Result<Job, Failure> {
    let settings = Settings {
        algorithm,
        softness,
        tolerance,
    };
    let constraints = Handles::new(mesh, indices, weights)?.constraints(indices.py(), mesh)?;
    let targets = arrays::positions("targets", targets)?;
    let shape = Arc::new(Shape::new(mesh, &constraints));
    let surface = Arc::clone(&shape.mesh);
    let work = move |stage: Stage| deform_with(&surface, constraints, &targets, settings, stage);
    Job::start(work, move |py, solution| shape.deformed(py, solution))
}
