//! The class `Deformation`, and the functions that deform once.

use std::sync::Arc;

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
use crate::parameters;

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

    pub fn deformed(&self, inner: deformation::Deformation) -> Deformation {
        Deformation {
            vertices: positions(&self.mesh) + &inner.displacement,
            inner,
            unconstrained: Arc::clone(&self.unconstrained),
        }
    }
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
/// MemoryError
///     If the work takes more than is available, before it starts.
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
    #[pyo3(from_py_with = parameters::softness)] softness: f64,
    #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
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
    #[pyo3(from_py_with = parameters::softness)] softness: f64,
    #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
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

/// Hands a deformation from a thread to Python.
pub fn converted(deformation: Deformation) -> Convert {
    Box::new(move |py| Ok(Py::new(py, deformation)?.into_any()))
}

/// Constraints as they came from Python.
pub fn constraints(
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
