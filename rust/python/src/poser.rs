//! The class `Poser`.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyList;
use spectral_tv::memory::needs;
use spectral_tv::monitor::Stage;
use spectral_tv::posing::{self, Settings, Snapshot};

use crate::arrays;
use crate::error::{Failure, refused};
use crate::handles::Handles;
use crate::job::{Job, guarded};
use crate::mesh::Mesh;
use crate::owned::Owned;
use crate::parameters;
use crate::pickling::{Parts, Pickled, Writer};
use crate::posing::{bodies, posed};
use crate::shape::Shape;

/// A mesh and what holds it, to be posed again and again.
///
/// Every pose starts from the last one. What the linear systems have in common is computed once. A
/// copy of a poser, and a pickled one, go on from its last pose too.
///
/// Parameters
/// ----------
/// mesh : Mesh
/// indices : (K,) array of integers, or (V,) array of bools
///     The constrained vertices, with those that stay where they are; or True for each of them.
/// weights : (K,) array, optional
///     In (0, 1]: 1, the default, is exact; less is a spring, as of a `Deformer`.
/// bodies : (K,) array of integers, optional
///     -1, the default: the vertex goes to its target. Vertices with the same other number are one
///     rigid body that turns freely: its centre, the mean of its vertices, goes to the mean of
///     their targets.
/// joint_softness : float
///     How wide and soft joints are, from 0 to 1e6; 0 folds them as sharply as the mesh allows.
/// stiffness : float
///     What turning costs, as a length relative to the diagonal of the bounding box, from 0 to 1e6.
/// stillness : float
///     What moving away from rest costs, from 0 to 1e6.
///
/// Raises
/// ------
/// MeshError
///     If there are no constraints, one is out of range, or no vertex is left to move. If a weight
///     or a parameter is out of its range, a body is below -1, or a vertex is in two bodies.
/// MemoryError
///     If the work takes more than is available, before it starts.
#[pyclass(frozen, module = "spectral_tv")]
pub struct Poser {
    inner: Arc<Owned<posing::Poser>>,
    shape: Arc<Shape>,
    mesh: Py<Mesh>,
    handles: Handles,
    bodies: Option<Vec<i64>>,
}

#[pymethods]
impl Poser {
    #[new]
    #[pyo3(signature = (mesh, indices, weights = None, bodies = None, joint_softness = 1.0, stiffness = 0.03, stillness = 0.5))]
    fn new(
        mesh: Bound<'_, Mesh>,
        indices: &Bound<'_, PyAny>,
        weights: Option<&Bound<'_, PyAny>>,
        bodies: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = parameters::joint_softness)] joint_softness: f64,
        #[pyo3(from_py_with = parameters::stiffness)] stiffness: f64,
        #[pyo3(from_py_with = parameters::stillness)] stillness: f64,
    ) -> Result<Self, Failure> {
        let settings = Settings {
            joint_softness,
            stiffness,
            stillness,
        };
        let handles = Handles::new(mesh.get(), indices, weights)?;
        Self::with(mesh, handles, self::bodies(bodies)?, settings, None)
    }

    /// Start making one in a thread of its own and return the `Job` at once.
    ///
    /// It takes the arguments of the class. Making one takes seconds on a large mesh.
    #[staticmethod]
    #[pyo3(signature = (mesh, indices, weights = None, bodies = None, joint_softness = 1.0, stiffness = 0.03, stillness = 0.5))]
    fn start(
        mesh: Bound<'_, Mesh>,
        indices: &Bound<'_, PyAny>,
        weights: Option<&Bound<'_, PyAny>>,
        bodies: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = parameters::joint_softness)] joint_softness: f64,
        #[pyo3(from_py_with = parameters::stiffness)] stiffness: f64,
        #[pyo3(from_py_with = parameters::stillness)] stillness: f64,
    ) -> Result<Job, Failure> {
        let settings = Settings {
            joint_softness,
            stiffness,
            stillness,
        };
        let handles = Handles::new(mesh.get(), indices, weights)?;
        let (build, wrap) = Self::steps(mesh, handles, self::bodies(bodies)?, settings, None)?;
        Job::start(build, move |py, built| {
            Ok(Bound::new(py, wrap(built))?.into_any())
        })
    }

    /// How wide and soft joints are; 0 folds them as sharply as the mesh allows.
    #[getter]
    fn joint_softness(&self, py: Python<'_>) -> Result<f64, Failure> {
        Ok(self.settings(py)?.joint_softness)
    }

    /// What turning costs, as a length relative to the diagonal of the bounding box.
    #[getter]
    fn stiffness(&self, py: Python<'_>) -> Result<f64, Failure> {
        Ok(self.settings(py)?.stiffness)
    }

    /// What moving away from rest costs.
    #[getter]
    fn stillness(&self, py: Python<'_>) -> Result<f64, Failure> {
        Ok(self.settings(py)?.stillness)
    }

    /// Take other parameters; the pose stays until the next step.
    ///
    /// Parameters
    /// ----------
    /// joint_softness, stiffness, stillness : float, optional
    ///     As of the class. What is None stays as it is.
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     If one is out of its range; all then stay as they are.
    #[pyo3(signature = (joint_softness = None, stiffness = None, stillness = None))]
    fn set_parameters(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = parameters::joint_softness)] joint_softness: Option<f64>,
        #[pyo3(from_py_with = parameters::stiffness)] stiffness: Option<f64>,
        #[pyo3(from_py_with = parameters::stillness)] stillness: Option<f64>,
    ) -> Result<(), Failure> {
        let poser = self.inner.take(py)?;
        guarded(py, |_| {
            let mut poser = poser.get();
            let known = poser.settings();
            poser.set_settings(Settings {
                joint_softness: joint_softness.unwrap_or(known.joint_softness),
                stiffness: stiffness.unwrap_or(known.stiffness),
                stillness: stillness.unwrap_or(known.stillness),
            })
        })
    }

    /// Take a step towards the pose for new targets, fast enough for dragging: on a coarse mesh,
    /// which the surface follows and is smoothed.
    ///
    /// After a small movement the result is near the pose that `solve` finds. After a large one
    /// some more calls are needed, or `solve`. The movement of the result tells how far it still
    /// went.
    ///
    /// Parameters
    /// ----------
    /// targets : (K, 3) array
    ///     Where the constrained vertices go.
    ///
    /// Returns
    /// -------
    /// Pose
    ///     Its decrement is None: it is not computed.
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     If targets are of the wrong shape, not finite, or two exact ones of a vertex differ.
    fn drag<'py>(
        &self,
        py: Python<'py>,
        targets: &Bound<'py, PyAny>,
    ) -> Result<Bound<'py, PyAny>, Failure> {
        let targets = arrays::positions("targets", targets)?;
        let poser = self.inner.take(py)?;
        let pose = guarded(py, |_| poser.get().drag(&targets))?;
        posed(py, &self.shape, pose)
    }

    /// Pose to a stationary point of the energy.
    ///
    /// Where handles turn by more than 45 degrees against each other, the pose follows them on their
    /// way there, as the shortest screw goes. What is half a turn apart may go either way.
    ///
    /// Parameters
    /// ----------
    /// targets : (K, 3) array
    ///     Where the constrained vertices go.
    /// tolerance : float
    ///     Decrement to reach, in (0, 1); see `Pose`.
    /// progress : callable, optional
    ///     Called with the fraction done; an exception it raises ends the work.
    ///
    /// Returns
    /// -------
    /// Pose
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     As `drag`, or for a tolerance out of range.
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

    /// Pose for a sequence of targets, each starting from the one before: the frames of an
    /// animation.
    ///
    /// Parameters
    /// ----------
    /// targets : sequence of N (K, 3) arrays
    /// tolerance : float
    ///     Decrement to reach, in (0, 1); see `Pose`.
    /// progress : callable, optional
    ///     Called with the fraction done; an exception it raises ends the work.
    ///
    /// Returns
    /// -------
    /// list of N Pose
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     As `solve`.
    /// MemoryError
    ///     If all of them take more than is available, before the work starts.
    #[pyo3(signature = (targets, tolerance = 1e-4, progress = None))]
    fn solve_sequence(
        &self,
        py: Python<'_>,
        targets: Vec<Bound<'_, PyAny>>,
        #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> Result<Py<PyAny>, Failure> {
        self.start_solve_sequence(targets, tolerance)?
            ._wait(py, progress)
    }

    /// Start `solve` in a thread of its own and return the `Job` at once. Other calls wait until
    /// it has ended or was cancelled.
    #[pyo3(signature = (targets, tolerance = 1e-4))]
    fn start_solve(
        &self,
        targets: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
    ) -> Result<Job, Failure> {
        let targets = arrays::positions("targets", targets)?;
        let (take, shape) = (self.inner.take_for_job()?, Arc::clone(&self.shape));
        let work = move |stage: Stage| take(stage)?.get().solve_with(&targets, tolerance, stage);
        Job::start(work, move |py, pose| posed(py, &shape, pose))
    }

    /// Start `solve_sequence` in a thread of its own and return the `Job` at once. Other calls
    /// wait until it has ended or was cancelled.
    #[pyo3(signature = (targets, tolerance = 1e-4))]
    fn start_solve_sequence(
        &self,
        targets: Vec<Bound<'_, PyAny>>,
        #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
    ) -> Result<Job, Failure> {
        let sequence = arrays::several_positions("targets", &targets)?;
        let (take, shape) = (self.inner.take_for_job()?, Arc::clone(&self.shape));
        let work = move |stage: Stage| {
            take(stage)?
                .get()
                .solve_sequence_with(&sequence, tolerance, stage)
        };
        Job::start(work, move |py, poses| {
            let posed = poses.into_iter().map(|pose| posed(py, &shape, pose));
            Ok(PyList::new(py, posed.collect::<Result<Vec<_>, _>>()?)?.into_any())
        })
    }

    fn __repr__(&self) -> String {
        format!(
            "Poser({} constraints on {} vertices)",
            self.handles.indices.len(),
            self.mesh.get().inner.vertex_count()
        )
    }
}

/// What takes long and needs no Python.
type Build = Box<dyn FnOnce(Stage) -> spectral_tv::Result<posing::Poser> + Send>;
/// What makes an object of that.
type Wrap = Box<dyn FnOnce(posing::Poser) -> Poser + Send>;

impl Poser {
    /// One that goes on from a state, or from rest.
    fn with(
        mesh: Bound<'_, Mesh>,
        handles: Handles,
        bodies: Option<Vec<i64>>,
        settings: Settings,
        state: Option<Snapshot>,
    ) -> Result<Self, Failure> {
        let py = mesh.py();
        let (build, wrap) = Self::steps(mesh, handles, bodies, settings, state)?;
        Ok(wrap(guarded(py, build)?))
    }

    /// What makes one, in two steps.
    fn steps(
        mesh: Bound<'_, Mesh>,
        handles: Handles,
        bodies: Option<Vec<i64>>,
        settings: Settings,
        state: Option<Snapshot>,
    ) -> Result<(Build, Wrap), Failure> {
        let held = handles.turning(mesh.py(), mesh.get(), bodies.as_deref())?;
        let shape = Arc::new(Shape::new(mesh.get(), held.floating()));
        let (surface, mesh) = (Arc::clone(&shape.mesh), mesh.unbind());
        let build = move |stage: Stage| {
            let mut built = posing::Poser::new_with(&surface, held, settings, stage)?;
            if let Some(state) = state {
                built.set_state(state)?;
            }
            Ok(built)
        };
        let wrap = move |built| Self {
            inner: Arc::new(Owned::new(built)),
            shape,
            mesh,
            handles,
            bodies,
        };
        Ok((Box::new(build), Box::new(wrap)))
    }

    fn settings(&self, py: Python<'_>) -> Result<Settings, Failure> {
        Ok(self.inner.take(py)?.get().settings())
    }

    /// The parameters and the last pose, once the work on it has ended; `None` at rest.
    fn state(&self, py: Python<'_>) -> Result<(Settings, Option<Snapshot>), Failure> {
        let poser = self.inner.take(py)?;
        guarded(py, |stage| {
            let vertices = self.mesh.get().inner.vertex_count() as u64;
            let what = "a copy of a poser's state";
            stage.claim(needs::functions(7, vertices), what, "free some memory")?;
            let poser = poser.get();
            Ok((poser.settings(), poser.state()))
        })
    }
}

impl Pickled for Poser {
    const NAME: &'static str = "Poser";

    fn write(&self, parts: &Writer<'_>) -> Result<(), Failure> {
        let (settings, state) = self.state(parts.py())?;
        parts.value("mesh", &self.mesh)?;
        self.handles.write(parts)?;
        match &self.bodies {
            Some(bodies) => parts.list("bodies", bodies)?,
            None => parts.value("bodies", None::<()>)?,
        }
        parts.value("joint_softness", settings.joint_softness)?;
        parts.value("stiffness", settings.stiffness)?;
        parts.value("stillness", settings.stillness)?;
        let Some(state) = state else {
            let names = ["targets", "positions", "rotations", "turns"];
            return names
                .iter()
                .try_for_each(|name| parts.value(name, None::<()>));
        };
        let targets = arrays::rows(parts.py(), state.targets.into_iter())?;
        parts.value("targets", targets)?;
        parts.matrix("positions", state.positions.view())?;
        parts.matrix("rotations", state.rotations.view())?;
        parts.matrix("turns", state.bodies.view())
    }

    fn read(_py: Python<'_>, parts: &Parts<'_>) -> Result<Self, Failure> {
        let handles = Handles::read(parts)?;
        let bodies = self::bodies(parts.optional("bodies")?.as_ref())?;
        let settings = Settings {
            joint_softness: parts.value("joint_softness")?,
            stiffness: parts.value("stiffness")?,
            stillness: parts.value("stillness")?,
        };
        let matrix = |name| match parts.optional(name)? {
            Some(value) => Ok(Some(arrays::matrix(name, &value, "float64")?)),
            None => Ok::<_, Failure>(None),
        };
        let numbers = (matrix("positions")?, matrix("rotations")?, matrix("turns")?);
        let state = match parts.optional("targets")? {
            None => None,
            Some(targets) => {
                let targets = arrays::positions("targets", &targets)?;
                let (Some(positions), Some(rotations), Some(bodies)) = numbers else {
                    let message = "the pickle of a Poser lacks a part of its last pose";
                    return Err(refused(message));
                };
                Some(Snapshot {
                    targets,
                    positions,
                    rotations,
                    bodies,
                })
            }
        };
        let mesh = parts
            .get("mesh")?
            .cast_into::<Mesh>()
            .map_err(PyErr::from)?;
        Self::with(mesh, handles, bodies, settings, state)
    }
}
