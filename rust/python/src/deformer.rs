//! The class `Deformer`.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use pyo3::prelude::*;
use spectral_tv::deformation;
use spectral_tv::monitor::Monitor;

use crate::arrays;
use crate::deformation::{Deformation, Shape, constraints, converted};
use crate::error::Failure;
use crate::job::{Convert, Job, Task, guarded};
use crate::mesh::Mesh;
use crate::parameters;

/// A mesh and the vertices that are constrained, to be deformed again and again.
///
/// Every deformation starts from the last one, and what the linear systems have in common is
/// worked out once.
///
/// Parameters
/// ----------
/// mesh : Mesh
/// indices : (K,) array of integers
///     The constrained vertices.
/// weights : (K,) array, optional
///     In (0, 1]: 1, the default, is exact; less is a spring. A patch of area a that hangs on a
///     cut of length p stays behind by about (1 - w) / w * p / sqrt(area) * area / (100 a) of the
///     movement.
/// softness : float
///     Width of the stretched zone, a length; 0 allows a jump within a ring of triangles.
///
/// Raises
/// ------
/// MeshError
///     If there are no constraints, one is out of range, a weight is not in (0, 1], no vertex is
///     left to move, or softness is negative.
#[pyclass(frozen, module = "spectral_tv")]
pub struct Deformer {
    inner: Arc<Mutex<deformation::Deformer>>,
    shape: Arc<Shape>,
}

#[pymethods]
impl Deformer {
    #[new]
    #[pyo3(signature = (mesh, indices, weights = None, softness = 0.0))]
    fn new(
        py: Python<'_>,
        mesh: &Mesh,
        indices: &Bound<'_, PyAny>,
        weights: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = parameters::softness)] softness: f64,
    ) -> Result<Self, Failure> {
        let constraints = constraints(mesh, indices, weights)?;
        let shape = Arc::new(Shape::new(mesh, &constraints));
        let mesh = &mesh.inner;
        let inner = guarded(py, || {
            let monitor = Monitor::new();
            deformation::Deformer::new(mesh, constraints, softness, monitor.whole())
        })?;
        Ok(Self {
            inner: Arc::new(Mutex::new(inner)),
            shape,
        })
    }

    /// Follow handles to new targets by a linear solution that starts from the last shape, and a
    /// Newton step where a shift has left it behind: what there is time for while they are
    /// dragged. Within some tenths of a percent of the optimum after a small movement; from rest,
    /// after a large one or when handles begin to turn it takes some calls, or `solve`. The gap of
    /// the result tells.
    ///
    /// Parameters
    /// ----------
    /// targets : (K, 3) array
    ///     Where the constrained vertices go.
    ///
    /// Returns
    /// -------
    /// Deformation
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     If targets are of the wrong shape, not finite, or two exact ones of a vertex differ.
    fn drag(&self, py: Python<'_>, targets: &Bound<'_, PyAny>) -> Result<Deformation, Failure> {
        let targets = arrays::positions("targets", targets)?;
        guarded(py, || {
            let inner = lock(&self.inner).drag(&targets)?;
            Ok(self.shape.deformed(inner))
        })
    }

    /// Deform to the optimum.
    ///
    /// Parameters
    /// ----------
    /// targets : (K, 3) array
    ///     Where the constrained vertices go.
    /// tolerance : float
    ///     Relative duality gap to reach, in (0, 1).
    /// progress : callable, optional
    ///     Called with the fraction done; an exception it raises ends the work.
    ///
    /// Returns
    /// -------
    /// Deformation
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     As `drag`, or for a tolerance out of range.
    #[pyo3(signature = (targets, tolerance = 1e-3, progress = None))]
    fn solve(
        &self,
        py: Python<'_>,
        targets: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> Result<Deformation, Failure> {
        let task = self.task(targets, tolerance, |deformation| deformation)?;
        task.wait(py, progress)
    }

    /// Deform to the optima for a sequence of targets, each starting from the one before: the
    /// frames of an animation.
    ///
    /// Parameters
    /// ----------
    /// targets : sequence of N (K, 3) arrays
    /// tolerance : float
    ///     Relative duality gap to reach, in (0, 1).
    /// progress : callable, optional
    ///     Called with the fraction done; an exception it raises ends the work.
    ///
    /// Returns
    /// -------
    /// list of N Deformation
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     As `solve`.
    #[pyo3(signature = (targets, tolerance = 1e-3, progress = None))]
    fn solve_sequence(
        &self,
        py: Python<'_>,
        targets: Vec<Bound<'_, PyAny>>,
        #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> Result<Vec<Deformation>, Failure> {
        let task = self.sequence_task(&targets, tolerance, |deformations| deformations)?;
        task.wait(py, progress)
    }

    /// Start `solve_sequence` in a thread of its own and return the `Job` at once. Other calls
    /// wait until it has ended or was cancelled.
    #[pyo3(signature = (targets, tolerance = 1e-3))]
    fn start_solve_sequence(
        &self,
        targets: Vec<Bound<'_, PyAny>>,
        #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
    ) -> Result<Job, Failure> {
        let task = self.sequence_task(&targets, tolerance, |deformations| -> Convert {
            Box::new(move |py| Ok(deformations.into_pyobject(py)?.unbind()))
        })?;
        Ok(Job::new(task))
    }

    /// Start `solve` in a thread of its own and return the `Job` at once. Other calls wait until
    /// it has ended or was cancelled.
    #[pyo3(signature = (targets, tolerance = 1e-3))]
    fn start_solve(
        &self,
        targets: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
    ) -> Result<Job, Failure> {
        Ok(Job::new(self.task(targets, tolerance, converted)?))
    }
}

impl Deformer {
    fn sequence_task<T: Send + 'static>(
        &self,
        targets: &[Bound<'_, PyAny>],
        tolerance: f64,
        wrap: impl FnOnce(Vec<Deformation>) -> T + Send + 'static,
    ) -> Result<Task<T>, Failure> {
        let positions = targets.iter().map(|t| arrays::positions("targets", t));
        let sequence = positions.collect::<PyResult<Vec<_>>>()?;
        let (inner, shape) = (Arc::clone(&self.inner), Arc::clone(&self.shape));
        Ok(Task::start(move |monitor| {
            let stage = monitor.whole();
            let solutions = lock(&inner).solve_sequence(&sequence, tolerance, stage)?;
            let deformed = solutions
                .into_iter()
                .map(|solution| shape.deformed(solution));
            Ok(wrap(deformed.collect()))
        })?)
    }

    fn task<T: Send + 'static>(
        &self,
        targets: &Bound<'_, PyAny>,
        tolerance: f64,
        wrap: impl FnOnce(Deformation) -> T + Send + 'static,
    ) -> Result<Task<T>, Failure> {
        let targets = arrays::positions("targets", targets)?;
        let (inner, shape) = (Arc::clone(&self.inner), Arc::clone(&self.shape));
        Ok(Task::start(move |monitor| {
            let solution = lock(&inner).solve(&targets, tolerance, monitor.whole())?;
            Ok(wrap(shape.deformed(solution)))
        })?)
    }
}

/// A panic leaves a deformer in a state that the next solution overwrites.
fn lock(deformer: &Mutex<deformation::Deformer>) -> MutexGuard<'_, deformation::Deformer> {
    deformer.lock().unwrap_or_else(PoisonError::into_inner)
}
