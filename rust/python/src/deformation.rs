//! The class `Deformation`, and the functions that deform once.

use std::sync::Arc;

use ndarray::Array2;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use spectral_tv::deformation::{self, Algorithm, Constraints, Settings};
use spectral_tv::memory::needs;
use spectral_tv::mesh::TriangleMesh;

use crate::arrays::{self, Vertices};
use crate::error::{Failure, refused};
use crate::job::{Convert, Job, Task, guarded};
use crate::mesh::Mesh;
use crate::parameters;
use crate::pickling::{Parts, Pickled, Reduced, Writer, reduced};

/// A deformed shape, made by `deform` or a `Deformer`.
#[pyclass(frozen, module = "spectral_tv")]
pub struct Deformation {
    /// (3, V).
    vertices: Array2<f64>,
    total_variation: f64,
    gap: f64,
    iterations: usize,
    unconstrained: Arc<Vec<i64>>,
}

#[pymethods]
impl Deformation {
    /// Positions of the deformed shape, (V, 3).
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
        arrays::per_vertex(py, self.vertices.view())
    }

    /// TV of the displacement, length².
    #[getter]
    fn total_variation(&self) -> f64 {
        self.total_variation
    }

    /// How far the energy can be above the least, relative to itself: a duality gap, so a proof.
    /// Of algorithms that do not minimise TV it says how far from the optimum they ended.
    #[getter]
    fn gap(&self) -> f64 {
        self.gap
    }

    /// Number of iterations.
    #[getter]
    fn iterations(&self) -> usize {
        self.iterations
    }

    /// Vertices of connected components without any constraint, (U,): each such piece moves
    /// rigidly with the surface nearest to it.
    #[getter]
    fn unconstrained<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<i64>>, Failure> {
        arrays::array_of(py, &self.unconstrained)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> Result<Reduced<'py>, Failure> {
        reduced(py, self)
    }

    /// The deformation itself: nothing can change it.
    fn __copy__(this: Bound<'_, Self>) -> Bound<'_, Self> {
        this
    }

    /// The deformation itself.
    fn __deepcopy__<'py>(this: Bound<'py, Self>, _memo: &Bound<'py, PyAny>) -> Bound<'py, Self> {
        this
    }

    fn __repr__(&self) -> String {
        format!(
            "Deformation({} vertices, gap {:.1e} after {} iterations)",
            self.vertices.ncols(),
            self.gap,
            self.iterations
        )
    }
}

impl Pickled for Deformation {
    const NAME: &'static str = "Deformation";

    fn write(&self, parts: &Writer<'_>) -> Result<(), Failure> {
        parts.matrix("vertices", self.vertices.view())?;
        parts.value("total_variation", self.total_variation)?;
        parts.value("gap", self.gap)?;
        parts.value("iterations", self.iterations)?;
        parts.list("unconstrained", &self.unconstrained)
    }

    fn read(_py: Python<'_>, parts: &Parts<'_>) -> Result<Self, Failure> {
        let vertices = parts.matrix("vertices")?;
        if vertices.nrows() != 3 {
            let message = "the vertices of a deformation have three coordinates";
            return Err(refused(message));
        }
        Ok(Self {
            vertices,
            total_variation: parts.value("total_variation")?,
            gap: parts.value("gap")?,
            iterations: parts.value("iterations")?,
            unconstrained: Arc::new(parts.indices("unconstrained")?),
        })
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

    pub fn deformed(&self, solution: deformation::Deformation) -> Deformation {
        let mut vertices = solution.displacement;
        for (mut vertex, rest) in vertices.columns_mut().into_iter().zip(self.mesh.vertices()) {
            for (axis, rest) in rest.iter().enumerate() {
                vertex[axis] += rest;
            }
        }
        Deformation {
            vertices,
            total_variation: solution.total_variation,
            gap: solution.gap,
            iterations: solution.iterations,
            unconstrained: Arc::clone(&self.unconstrained),
        }
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

/// Move some vertices of a mesh, and have the surface follow in rigid pieces, the stretch going
/// to its bottlenecks: the displacement of least total variation (Brokman et al. 2024, section
/// "Shape Deformation").
///
/// Parameters
/// ----------
/// mesh : Mesh
/// indices : (K,) array of integers, or (V,) array of bools
///     The constrained vertices, those included that stay; or True for each of them.
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
    let asked = (indices, targets, weights);
    let task = start(py, mesh, asked, settings, |shape| shape)?;
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
#[expect(
    clippy::too_many_arguments,
    reason = "keyword arguments of a Python function"
)]
pub fn start_deform(
    py: Python<'_>,
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
    let task = start(py, mesh, (indices, targets, weights), settings, converted)?;
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
    py: Python<'_>,
    mesh: &Mesh,
    (indices, targets, weights): Asked,
    settings: Settings,
    wrap: impl FnOnce(Deformation) -> T + Send + 'static,
) -> Result<Task<T>, Failure> {
    let constraints = Handles::new(mesh, indices, weights)?.constraints(py, mesh)?;
    let targets = arrays::positions("targets", targets)?;
    let shape = Shape::new(mesh, &constraints);
    Task::start(move |monitor| {
        let stage = monitor.whole();
        let solution = deformation::deform(&shape.mesh, constraints, &targets, settings, stage)?;
        Ok(wrap(shape.deformed(solution)))
    })
}

/// Hands a deformation from a thread to Python.
pub fn converted(deformation: Deformation) -> Convert {
    Box::new(move |py| Ok(Py::new(py, deformation)?.into_any()))
}

fn parse_algorithm(name: &str) -> Result<Algorithm, Failure> {
    match name {
        "convex" => Ok(Algorithm::Convex),
        "paper" => Ok(Algorithm::Paper),
        "harmonic" => Ok(Algorithm::Harmonic),
        "biharmonic" => Ok(Algorithm::Biharmonic),
        "arap" => Ok(Algorithm::AsRigidAsPossible),
        other => Err(refused(format!(
            "algorithm must be \"convex\", \"paper\", \"harmonic\", \"biharmonic\" or \"arap\", \
             not {other:?}"
        ))),
    }
}
