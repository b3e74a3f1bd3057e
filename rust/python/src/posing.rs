//! The function that starts a pose, its result, and the defaults of its parameters.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use spectral_tv::monitor::Stage;
use spectral_tv::posing::{self, Settings, pose_with};

use crate::arrays;
use crate::error::Failure;
use crate::handles::Handles;
use crate::job::Job;
use crate::mesh::Mesh;
use crate::parameters::{self, Number};
use crate::shape::Shape;

/// The decrement that is reached unless another is asked for.
const TOLERANCE: f64 = 1e-4;

/// The defaults by the names of the parameters, for the package.
pub fn defaults(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let (defaults, known) = (PyDict::new(py), Settings::default());
    defaults.set_item("joint_softness", known.joint_softness)?;
    defaults.set_item("stiffness", known.stiffness)?;
    defaults.set_item("stillness", known.stillness)?;
    defaults.set_item("tolerance", TOLERANCE)?;
    Ok(defaults)
}

/// The parameters by their names.
fn settings(parameters: &Bound<'_, PyDict>) -> PyResult<Settings> {
    let number = |name: &str| f64::read(name, &parameters.as_any().get_item(name)?);
    Ok(Settings {
        joint_softness: number("joint_softness")?,
        stiffness: number("stiffness")?,
        stillness: number("stillness")?,
    })
}

/// A number for each constraint: of the rigid body it is in, −1 for none.
pub fn bodies(bodies: Option<&Bound<'_, PyAny>>) -> Result<Option<Vec<i64>>, Failure> {
    let read = |bodies| arrays::indices("bodies", bodies);
    bodies.map(read).transpose()
}

/// The result of the package.
pub fn posed<'py>(
    py: Python<'py>,
    shape: &Shape,
    pose: posing::Pose,
) -> Result<Bound<'py, PyAny>, Failure> {
    let fields = shape
        .displaced(py, pose.displacement)?
        .with("rotations", arrays::per_vertex(py, pose.rotations.view())?)?
        .with("energy", pose.energy)?
        .with("decrement", pose.decrement)?
        .with("movement", pose.movement)?
        .with("iterations", pose.iterations)?;
    Ok(fields.made("Pose")?)
}

#[pyfunction]
pub fn start_pose(
    mesh: &Mesh,
    indices: &Bound<'_, PyAny>,
    targets: &Bound<'_, PyAny>,
    weights: Option<&Bound<'_, PyAny>>,
    bodies: Option<&Bound<'_, PyAny>>,
    parameters: &Bound<'_, PyDict>,
    #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
) -> Result<Job, Failure> {
    let settings = settings(parameters)?;
    let bodies = self::bodies(bodies)?;
    let handles = Handles::new(mesh, indices, weights)?;
    let handles = handles.turning(indices.py(), mesh, bodies.as_deref())?;
    let targets = arrays::positions("targets", targets)?;
    let shape = Arc::new(Shape::new(mesh, handles.floating()));
    let surface = Arc::clone(&shape.mesh);
    let work =
        move |stage: Stage| pose_with(&surface, handles, &targets, settings, tolerance, stage);
    Job::start(work, move |py, pose| posed(py, &shape, pose))
}
