//! The class `Deformer`.

use std::sync::Arc;

use ndarray::Array2;
use pyo3::prelude::*;
use pyo3::types::PyList;
use spectral_tv::deformation;
use spectral_tv::memory::needs;
use spectral_tv::monitor::Stage;

use crate::arrays;
use crate::deformation::deformed;
use crate::error::Failure;
use crate::handles::Handles;
use crate::job::{Job, guarded};
use crate::mesh::Mesh;
use crate::owned::Owned;
use crate::parameters;
use crate::pickling::{Parts, Pickled, Writer};
use crate::shape::Shape;

/// A mesh and the vertices that are constrained, to be deformed again and again.
///
/// Every deformation starts from the last one. What the linear systems have in common is computed
/// once. A copy of a deformer, and a pickled one, go on from its last deformation too.
///
/// Parameters
/// ----------
/// mesh : Mesh
/// indices : (K,) array of integers, or (V,) array of bools
///     The constrained vertices; or True for each of them.
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
    inner: Arc<Owned<deformation::Deformer>>,
    shape: Arc<Shape>,
    mesh: Py<Mesh>,
    handles: Handles,
    softness: f64,
}

#[pymethods]
impl Deformer {
    #[new]
    #[pyo3(signature = (mesh, indices, weights = None, softness = 0.0))]
    fn new(
        mesh: Bound<'_, Mesh>,
        indices: &Bound<'_, PyAny>,
        weights: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = parameters::softness)] softness: f64,
    ) -> Result<Self, Failure> {
        let handles = Handles::new(mesh.get(), indices, weights)?;
        Self::with(mesh, handles, softness, None)
    }

    /// Start making one in a thread of its own and return the `Job` at once.
    ///
    /// It takes the arguments of the class. Making one takes seconds on a large mesh.
    #[staticmethod]
    #[pyo3(signature = (mesh, indices, weights = None, softness = 0.0))]
    fn start(
        mesh: Bound<'_, Mesh>,
        indices: &Bound<'_, PyAny>,
        weights: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = parameters::softness)] softness: f64,
    ) -> Result<Job, Failure> {
        let handles = Handles::new(mesh.get(), indices, weights)?;
        let (build, wrap) = Self::steps(mesh, handles, softness, None)?;
        Job::start(build, move |py, built| {
            Ok(Bound::new(py, wrap(built))?.into_any())
        })
    }

    /// Follow handles to new targets, fast enough for dragging: a linear solution that starts from
    /// the last shape, and a Newton step if a shift has left the shape behind.
    ///
    /// After a small movement the result is within some tenths of a percent of the optimum. From
    /// rest, after a large movement or when handles begin to turn, some more calls are needed, or
    /// `solve`. The gap of the result tells how far it is from the optimum.
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
    fn drag<'py>(
        &self,
        py: Python<'py>,
        targets: &Bound<'py, PyAny>,
    ) -> Result<Bound<'py, PyAny>, Failure> {
        let targets = arrays::positions("targets", targets)?;
        let deformer = self.inner.take(py)?;
        let solution = guarded(py, |_| deformer.get().drag(&targets))?;
        deformed(py, &self.shape, solution)
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
    ) -> Result<Py<PyAny>, Failure> {
        self.start_solve(targets, tolerance)?._wait(py, progress)
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
    ) -> Result<Py<PyAny>, Failure> {
        self.start_solve_sequence(targets, tolerance)?
            ._wait(py, progress)
    }

    /// Start `drag` in a thread of its own and return the `Job` at once. Other calls wait until it
    /// has ended or was cancelled.
    fn start_drag(&self, targets: &Bound<'_, PyAny>) -> Result<Job, Failure> {
        let targets = arrays::positions("targets", targets)?;
        let (take, shape) = (self.inner.take_for_job()?, Arc::clone(&self.shape));
        Job::start_short(
            take,
            move |deformer, stage| deformer.get().drag_with(&targets, stage),
            move |py, solution| deformed(py, &shape, solution),
        )
    }

    /// Start `solve` in a thread of its own and return the `Job` at once. Other calls wait until
    /// it has ended or was cancelled.
    #[pyo3(signature = (targets, tolerance = 1e-3))]
    fn start_solve(
        &self,
        targets: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
    ) -> Result<Job, Failure> {
        let targets = arrays::positions("targets", targets)?;
        let (take, shape) = (self.inner.take_for_job()?, Arc::clone(&self.shape));
        let work = move |stage: Stage| take(stage)?.get().solve_with(&targets, tolerance, stage);
        Job::start(work, move |py, solution| deformed(py, &shape, solution))
    }

    /// Start `solve_sequence` in a thread of its own and return the `Job` at once. Other calls
    /// wait until it has ended or was cancelled.
    #[pyo3(signature = (targets, tolerance = 1e-3))]
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
        Job::start(work, move |py, solutions| {
            let deformed = solutions
                .into_iter()
                .map(|solution| deformed(py, &shape, solution));
            Ok(PyList::new(py, deformed.collect::<Result<Vec<_>, _>>()?)?.into_any())
        })
    }

    fn __repr__(&self) -> String {
        format!(
            "Deformer({} constraints on {} vertices)",
            self.handles.indices.len(),
            self.mesh.get().inner.vertex_count()
        )
    }
}

/// What takes long and needs no Python.
type Build = Box<dyn FnOnce(Stage) -> spectral_tv::Result<deformation::Deformer> + Send>;
/// What makes an object of that.
type Wrap = Box<dyn FnOnce(deformation::Deformer) -> Deformer + Send>;

impl Deformer {
    /// One that goes on from a state, or from rest.
    fn with(
        mesh: Bound<'_, Mesh>,
        handles: Handles,
        softness: f64,
        state: Option<Array2<f64>>,
    ) -> Result<Self, Failure> {
        let py = mesh.py();
        let (build, wrap) = Self::steps(mesh, handles, softness, state)?;
        Ok(wrap(guarded(py, build)?))
    }

    /// What makes one, in two steps.
    fn steps(
        mesh: Bound<'_, Mesh>,
        handles: Handles,
        softness: f64,
        state: Option<Array2<f64>>,
    ) -> Result<(Build, Wrap), Failure> {
        let constraints = handles.constraints(mesh.py(), mesh.get())?;
        let shape = Arc::new(Shape::new(mesh.get(), constraints.floating()));
        let (surface, mesh) = (Arc::clone(&shape.mesh), mesh.unbind());
        let build = move |stage: Stage| {
            let mut built =
                deformation::Deformer::new_with(&surface, constraints, softness, stage)?;
            if let Some(displacement) = state {
                built.set_state(displacement)?;
            }
            Ok(built)
        };
        let wrap = move |built| Self {
            inner: Arc::new(Owned::new(built)),
            shape,
            mesh,
            handles,
            softness,
        };
        Ok((Box::new(build), Box::new(wrap)))
    }

    /// The last displacement, once the work on it has ended; `None` at rest.
    fn state(&self, py: Python<'_>) -> Result<Option<Array2<f64>>, Failure> {
        let deformer = self.inner.take(py)?;
        guarded(py, |stage| {
            let vertices = self.mesh.get().inner.vertex_count() as u64;
            let what = "a copy of a deformer's state";
            stage.claim(needs::functions(3, vertices), what, "free some memory")?;
            Ok(deformer.get().state().cloned())
        })
    }
}

impl Pickled for Deformer {
    const NAME: &'static str = "Deformer";

    fn write(&self, parts: &Writer<'_>) -> Result<(), Failure> {
        let state = self.state(parts.py())?;
        parts.value("mesh", &self.mesh)?;
        self.handles.write(parts)?;
        parts.value("softness", self.softness)?;
        parts.value("is_at_rest", state.is_none())?;
        let vertices = self.mesh.get().inner.vertex_count();
        let displacement = state.unwrap_or_else(|| Array2::zeros((3, vertices)));
        parts.matrix("displacement", displacement.view())
    }

    fn read(_py: Python<'_>, parts: &Parts<'_>) -> Result<Self, Failure> {
        let handles = Handles::read(parts)?;
        let state = match parts.value("is_at_rest")? {
            true => None,
            false => Some(parts.matrix("displacement")?),
        };
        let mesh = parts
            .get("mesh")?
            .cast_into::<Mesh>()
            .map_err(PyErr::from)?;
        Self::with(mesh, handles, parts.value("softness")?, state)
    }
}
