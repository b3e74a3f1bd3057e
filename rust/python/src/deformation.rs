//! The classes `Deformation` and `Deformer`, and the functions that deform once.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use ndarray::Array2;
use numpy::{IntoPyArray, PyArray1, PyArray2};
use pyo3::prelude::*;
use spectral_tv::Error;
use spectral_tv::deformation::{self, Algorithm, Constraints, Settings};
use spectral_tv::mesh::TriangleMesh;
use spectral_tv::operators::positions;

use crate::arrays;
use crate::error::Failure;
use crate::job::{Convert, Job, Task};
use crate::mesh::Mesh;

/// A deformed shape, made by `deform` or a `Deformer`.
#[pyclass(frozen, module = "spectral_tv")]
pub struct Deformation {
    inner: deformation::Deformation,
    vertices: Array2<f64>,
    unconstrained: Arc<Vec<i64>>,
}

#[pymethods]
impl Deformation {
    /// Positions of the deformed shape, (V, 3).
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        arrays::per_vertex(py, &self.vertices)
    }

    /// TV of the displacement, length².
    #[getter]
    fn total_variation(&self) -> f64 {
        self.inner.total_variation
    }

    /// How far the energy can be above the least, relative to itself: a duality gap, so a proof.
    /// Of algorithms that do not minimise TV it says how far from the optimum they ended.
    #[getter]
    fn gap(&self) -> f64 {
        self.inner.gap
    }

    /// Number of iterations.
    #[getter]
    fn iterations(&self) -> usize {
        self.inner.iterations
    }

    /// Vertices of connected components without any constraint, (U,): each such piece moves
    /// rigidly with the surface nearest to it.
    #[getter]
    fn unconstrained<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        self.unconstrained.to_vec().into_pyarray(py)
    }

    fn __repr__(&self) -> String {
        format!(
            "Deformation({} vertices, gap {:.1e} after {} iterations)",
            self.vertices.ncols(),
            self.inner.gap,
            self.inner.iterations
        )
    }
}

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

/// What turns a displacement into a deformed shape.
struct Shape {
    mesh: Arc<TriangleMesh>,
    unconstrained: Arc<Vec<i64>>,
}

impl Shape {
    fn new(mesh: &Mesh, constraints: &Constraints) -> Self {
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

    fn deformed(&self, inner: deformation::Deformation) -> Deformation {
        Deformation {
            vertices: positions(&self.mesh) + &inner.displacement,
            inner,
            unconstrained: Arc::clone(&self.unconstrained),
        }
    }
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
        softness: f64,
    ) -> Result<Self, Failure> {
        let constraints = constraints(mesh, indices, weights)?;
        let shape = Arc::new(Shape::new(mesh, &constraints));
        let mesh = &mesh.inner;
        let inner = py.detach(|| deformation::Deformer::new(mesh, constraints, softness))?;
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
        Ok(py.detach(|| {
            let inner = lock(&self.inner).drag(&targets)?;
            Ok::<_, Error>(self.shape.deformed(inner))
        })?)
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
        tolerance: f64,
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
        tolerance: f64,
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
        tolerance: f64,
    ) -> Result<Job, Failure> {
        let task = self.sequence_task(&targets, tolerance, |deformations| -> Convert {
            Box::new(move |py| Ok(deformations.into_pyobject(py)?.unbind()))
        })?;
        Ok(Job::new(task))
    }

    /// Start `solve` in a thread of its own and return the `Job` at once. Other calls wait until
    /// it has ended or was cancelled.
    #[pyo3(signature = (targets, tolerance = 1e-3))]
    fn start_solve(&self, targets: &Bound<'_, PyAny>, tolerance: f64) -> Result<Job, Failure> {
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

/// Move some vertices of a mesh, and have the surface follow in rigid pieces, the stretch going
/// to its bottlenecks: the displacement of least total variation (Brokman et al. 2024, section
/// "Shape Deformation").
///
/// Parameters
/// ----------
/// mesh : Mesh
/// indices : (K,) array of integers
///     The constrained vertices, those included that stay.
/// targets : (K, 3) array
///     Where they go.
/// weights : (K,) array, optional
///     In (0, 1]: 1, the default, is exact; less is a spring. See `Deformer`.
/// softness : float
///     Width of the stretched zone, a length; for "convex" only.
/// tolerance : float
///     Relative duality gap to reach, in (0, 1). "paper" and "arap" end where no vertex moves by
///     more than this part of the movement.
/// algorithm : {"convex", "paper", "harmonic", "biharmonic", "arap"}
///     "convex": the problem itself, by primal-dual Newton. "paper": Algorithm 1 of Brokman et al.
///     The others minimise something else, for comparison.
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
///     If an argument is of the wrong shape, not finite, or out of range; if there are no
///     constraints, two exact targets of a vertex differ, or no vertex is left to move.
#[pyfunction]
#[pyo3(signature = (mesh, indices, targets, weights = None, softness = 0.0, tolerance = 1e-3,
                    algorithm = "convex", progress = None))]
#[expect(
    clippy::too_many_arguments,
    reason = "keyword arguments of a Python function"
)]
pub fn deform(
    py: Python<'_>,
    mesh: &Mesh,
    indices: &Bound<'_, PyAny>,
    targets: &Bound<'_, PyAny>,
    weights: Option<&Bound<'_, PyAny>>,
    softness: f64,
    tolerance: f64,
    algorithm: &str,
    progress: Option<&Bound<'_, PyAny>>,
) -> Result<Deformation, Failure> {
    let settings = Settings {
        algorithm: parse_algorithm(algorithm)?,
        softness,
        tolerance,
    };
    let task = start(mesh, (indices, targets, weights), settings, |shape| shape)?;
    task.wait(py, progress)
}

/// Start `deform` in a thread of its own and return the `Job` at once.
///
/// Takes the arguments of `deform`, without `progress`; `Job.result` gives the `Deformation`.
///
/// Raises
/// ------
/// MeshError
///     If an argument cannot be read; what only the work finds out, `Job.result` raises.
#[pyfunction]
#[pyo3(signature = (mesh, indices, targets, weights = None, softness = 0.0, tolerance = 1e-3,
                    algorithm = "convex"))]
pub fn start_deform(
    mesh: &Mesh,
    indices: &Bound<'_, PyAny>,
    targets: &Bound<'_, PyAny>,
    weights: Option<&Bound<'_, PyAny>>,
    softness: f64,
    tolerance: f64,
    algorithm: &str,
) -> Result<Job, Failure> {
    let settings = Settings {
        algorithm: parse_algorithm(algorithm)?,
        softness,
        tolerance,
    };
    let task = start(mesh, (indices, targets, weights), settings, converted)?;
    Ok(Job::new(task))
}

/// Indices, targets and weights as they came.
type Asked<'a, 'py> = (
    &'a Bound<'py, PyAny>,
    &'a Bound<'py, PyAny>,
    Option<&'a Bound<'py, PyAny>>,
);

/// Starts the work in a thread; `wrap` makes of its result what the thread hands over.
fn start<T: Send + 'static>(
    mesh: &Mesh,
    (indices, targets, weights): Asked,
    settings: Settings,
    wrap: impl FnOnce(Deformation) -> T + Send + 'static,
) -> Result<Task<T>, Failure> {
    let constraints = constraints(mesh, indices, weights)?;
    let targets = arrays::positions("targets", targets)?;
    let shape = Shape::new(mesh, &constraints);
    Ok(Task::start(move |monitor| {
        let stage = monitor.whole();
        let solution = deformation::deform(&shape.mesh, constraints, &targets, settings, stage)?;
        Ok(wrap(shape.deformed(solution)))
    })?)
}

fn converted(deformation: Deformation) -> Convert {
    Box::new(move |py| Ok(Py::new(py, deformation)?.into_any()))
}

fn constraints(
    mesh: &Mesh,
    indices: &Bound<'_, PyAny>,
    weights: Option<&Bound<'_, PyAny>>,
) -> Result<Constraints, Failure> {
    let indices = arrays::indices("indices", indices)?;
    let weights = match weights {
        Some(weights) => Some(arrays::list("weights", weights)?),
        None => None,
    };
    Ok(Constraints::new(&mesh.inner, &indices, weights.as_deref())?)
}

fn parse_algorithm(name: &str) -> Result<Algorithm, Failure> {
    match name {
        "convex" => Ok(Algorithm::Convex),
        "paper" => Ok(Algorithm::Paper),
        "harmonic" => Ok(Algorithm::Harmonic),
        "biharmonic" => Ok(Algorithm::Biharmonic),
        "arap" => Ok(Algorithm::AsRigidAsPossible),
        other => Err(Error::Argument(format!(
            "algorithm must be \"convex\", \"paper\", \"harmonic\", \"biharmonic\" or \"arap\", \
             not {other:?}"
        ))
        .into()),
    }
}
