//! The class `Poser`.

use std::sync::Arc;

use pyo3::prelude::*;
use spectral_tv::mesh::TriangleMesh;
use spectral_tv::monitor::Stage;
use spectral_tv::posing::{self, Settings};

use crate::arrays;
use crate::error::Failure;
use crate::job::{Job, guarded};
use crate::mesh::Mesh;
use crate::owned::Owned;
use crate::parameters;
use crate::results::Fields;

/// A mesh and its handles, to be posed again and again.
#[pyclass(frozen, module = "spectral_tv")]
pub struct Poser {
    inner: Arc<Owned<posing::Poser>>,
    mesh: Arc<TriangleMesh>,
}

#[pymethods]
impl Poser {
    #[new]
    #[pyo3(signature = (mesh, indices, weights = None, bodies = None, joint_softness = 1.0, stiffness = 0.03, stillness = 0.5))]
    fn new(
        mesh: Bound<'_, Mesh>,
        indices: Vec<i64>,
        weights: Option<Vec<f64>>,
        bodies: Option<Vec<i64>>,
        joint_softness: f64,
        stiffness: f64,
        stillness: f64,
    ) -> Result<Self, Failure> {
        let py = mesh.py();
        let settings = Settings {
            joint_softness,
            stiffness,
            stillness,
        };
        let surface = Arc::clone(&mesh.get().inner);
        let inner = guarded(py, |stage| {
            let handles =
                posing::Handles::new(&surface, &indices, weights.as_deref(), bodies.as_deref())?;
            posing::Poser::new_with(&surface, handles, settings, stage)
        })?;
        Ok(Self {
            inner: Arc::new(Owned::new(inner)),
            mesh: surface,
        })
    }

    fn drag<'py>(
        &self,
        py: Python<'py>,
        targets: &Bound<'py, PyAny>,
    ) -> Result<Bound<'py, PyAny>, Failure> {
        let targets = arrays::positions("targets", targets)?;
        let poser = self.inner.take(py)?;
        let pose = guarded(py, |_| poser.get().drag(&targets))?;
        posed(py, &self.mesh, pose)
    }

    #[pyo3(signature = (targets, tolerance = 1e-4, progress = None))]
    fn solve(
        &self,
        py: Python<'_>,
        targets: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> Result<Py<PyAny>, Failure> {
        self.start_solve(targets, tolerance)?._wait(py, progress)
    }

    /// Take other parameters; the pose stays until the next step.
    #[pyo3(signature = (joint_softness = 1.0, stiffness = 0.03, stillness = 0.5))]
    fn set_parameters(
        &self,
        py: Python<'_>,
        joint_softness: f64,
        stiffness: f64,
        stillness: f64,
    ) -> Result<(), Failure> {
        let settings = Settings {
            joint_softness,
            stiffness,
            stillness,
        };
        let poser = self.inner.take(py)?;
        guarded(py, |_| poser.get().set_settings(settings))
    }

    #[pyo3(signature = (targets, tolerance = 1e-4))]
    fn start_solve(
        &self,
        targets: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
    ) -> Result<Job, Failure> {
        let targets = arrays::positions("targets", targets)?;
        let (take, mesh) = (self.inner.take_for_job()?, Arc::clone(&self.mesh));
        let work = move |stage: Stage| take(stage)?.get().solve_with(&targets, tolerance, stage);
        Job::start(work, move |py, pose| posed(py, &mesh, pose))
    }
}

fn posed<'py>(
    py: Python<'py>,
    mesh: &TriangleMesh,
    pose: posing::Pose,
) -> Result<Bound<'py, PyAny>, Failure> {
    let mut vertices = pose.displacement;
    for (mut vertex, rest) in vertices.columns_mut().into_iter().zip(mesh.vertices()) {
        for (axis, rest) in rest.iter().enumerate() {
            vertex[axis] += rest;
        }
    }
    let fields = Fields::new(py)
        .with("vertices", arrays::per_vertex(py, vertices.view())?)?
        .with("rotations", arrays::per_vertex(py, pose.rotations.view())?)?
        .with("energy", pose.energy)?
        .with("decrement", pose.decrement)?
        .with("movement", pose.movement)?
        .with("iterations", pose.iterations)?;
    Ok(fields.made("Pose")?)
}
