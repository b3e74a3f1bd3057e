//! The class `Accuracy` and the functions that measure it.

use std::sync::Arc;

use ndarray::Array2;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use spectral_tv::method::{self, AccuracyRequest, Errors};

use crate::arrays;
use crate::error::{Failure, refused};
use crate::job::{Convert, Job, Task};
use crate::mesh::Mesh;
use crate::parameters;
use crate::pickling::{Parts, Pickled, Reduced, Writer, reduced};
use crate::settings::Request;

/// How the errors of a decomposition fall with the number of steps, measured by `accuracy`.
///
/// Those of the package's steps and transform, and under `paper_` those of the paper's: weights
/// lagged by a step, and the residual R = T p(u(T)) + u(T) with p taken at u(T) (Brokman et al.
/// 2024, Eq. 53), whose all-pass filter does not give the shape back.
#[pyclass(frozen, module = "spectral_tv")]
pub struct Accuracy {
    inner: method::Accuracy,
}

#[pymethods]
impl Accuracy {
    /// The numbers of steps, (n,).
    #[getter]
    fn steps<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<i64>>, Failure> {
        arrays::array_of(py, &self.signed_steps())
    }

    /// Where the bands begin and end, (K+1,), length².
    #[getter]
    fn edges<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
        arrays::array_of(py, &self.inner.edges)
    }

    /// Distance of the all-pass filter's shape from the shape at every vertex, (n, V), length:
    /// rounding, by construction.
    #[getter]
    fn all_pass<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
        arrays::table_of(py, self.inner.ours.all_pass.view())
    }

    /// The same of the paper's transform, (n, V), length.
    #[getter]
    fn paper_all_pass<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
        arrays::table_of(py, self.inner.paper.all_pass.view())
    }

    /// Distance of the bands from those of the refined flow at every vertex, (n, V), length: the
    /// root of the sum of squares over the bands.
    #[getter]
    fn bands<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
        arrays::table_of(py, self.inner.ours.bands.view())
    }

    /// The same of the paper's steps, (n, V), length.
    #[getter]
    fn paper_bands<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
        arrays::table_of(py, self.inner.paper.bands.view())
    }

    /// L² error of each band over the surface, relative to the band's norm; to 1e-12 of the
    /// largest where a band has less, (n, K).
    #[getter]
    fn relative<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
        arrays::table_of(py, self.inner.ours.relative.view())
    }

    /// The same of the paper's steps, (n, K).
    #[getter]
    fn paper_relative<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
        arrays::table_of(py, self.inner.paper.relative.view())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> Result<Reduced<'py>, Failure> {
        reduced(py, self)
    }

    /// The result itself: nothing can change it.
    fn __copy__(this: Bound<'_, Self>) -> Bound<'_, Self> {
        this
    }

    /// The result itself.
    fn __deepcopy__<'py>(this: Bound<'py, Self>, _memo: &Bound<'py, PyAny>) -> Bound<'py, Self> {
        this
    }

    fn __repr__(&self) -> String {
        format!("Accuracy(steps {:?})", self.inner.steps)
    }
}

impl Accuracy {
    fn signed_steps(&self) -> Vec<i64> {
        self.inner.steps.iter().map(|&count| count as i64).collect()
    }
}

impl Pickled for Accuracy {
    const NAME: &'static str = "Accuracy";

    fn write(&self, parts: &Writer<'_>) -> Result<(), Failure> {
        parts.list("steps", &self.signed_steps())?;
        parts.list("edges", &self.inner.edges)?;
        for (way, errors) in [("", &self.inner.ours), ("paper_", &self.inner.paper)] {
            parts.matrix(&format!("{way}all_pass"), errors.all_pass.view())?;
            parts.matrix(&format!("{way}bands"), errors.bands.view())?;
            parts.matrix(&format!("{way}relative"), errors.relative.view())?;
        }
        Ok(())
    }

    fn read(_py: Python<'_>, parts: &Parts<'_>) -> Result<Self, Failure> {
        let errors = |way: &str| -> Result<Errors, Failure> {
            Ok(Errors {
                all_pass: parts.matrix(&format!("{way}all_pass"))?,
                bands: parts.matrix(&format!("{way}bands"))?,
                relative: parts.matrix(&format!("{way}relative"))?,
            })
        };
        let inner = method::Accuracy {
            steps: step_counts(&parts.get("steps")?)?,
            edges: parts.list("edges")?,
            ours: errors("")?,
            paper: errors("paper_")?,
        };
        let vertices = (inner.steps.len(), inner.ours.all_pass.ncols());
        let bands = (inner.steps.len(), inner.edges.len().saturating_sub(1));
        let is_right = [&inner.ours, &inner.paper].into_iter().all(|errors| {
            let shapes = [&errors.all_pass, &errors.bands, &errors.relative].map(Array2::dim);
            shapes == [vertices, vertices, bands]
        });
        match is_right {
            true => Ok(Self { inner }),
            false => {
                let message = "the parts of the accuracy have shapes that do not go together";
                Err(refused(message))
            }
        }
    }
}

/// Measure how the errors of a decomposition fall with the number of steps: of the all-pass
/// filter, as in the paper's figure of the reconstruction error, and of the bands against a
/// refined flow.
///
/// An all-pass filter that gives the shape back says nothing about the flow, as the package's does
/// so at any step; the error of the bands does.
///
/// Parameters
/// ----------
/// mesh : Mesh
/// method : {"m1", "m2", "m3", "naive", "heat"}
/// steps : (n,) array of integers
///     The numbers of steps to compare, at least 2 each.
/// bands : int
///     Number of bands K.
/// progress : callable, optional
///     Called with the fraction done; an exception it raises ends the work.
/// scales : (float, float), optional
///     The finest and the largest scale, length²; see `graded_times`. Default: the method's.
/// refinement : int
///     The refined flow has so many times the most steps, at least 2.
/// scheme, tolerance, solver, p, base, base_time, metric
///     As `decompose` takes them; the paper's steps are "lagged".
///
/// Returns
/// -------
/// Accuracy
///
/// Raises
/// ------
/// MeshError
///     If an argument is of the wrong shape or out of range, or the method takes no time steps.
#[pyfunction]
#[pyo3(signature = (mesh, method = "m1", steps = None, bands = 5, progress = None, *,
                    scales = None, refinement = 8, scheme = "extrapolated", tolerance = 1e-3,
                    solver = "auto", p = 3, base = None, base_time = None,
                    metric = "surface"))]
#[expect(
    clippy::too_many_arguments,
    reason = "keyword arguments of a Python function"
)]
pub fn accuracy(
    py: Python<'_>,
    mesh: &Mesh,
    method: &str,
    steps: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = parameters::bands)] bands: usize,
    progress: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = parameters::scales)] scales: Option<(f64, f64)>,
    #[pyo3(from_py_with = parameters::refinement)] refinement: usize,
    scheme: &str,
    #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
    solver: &str,
    #[pyo3(from_py_with = parameters::p)] p: u32,
    base: Option<Bound<'_, PyAny>>,
    #[pyo3(from_py_with = parameters::base_time)] base_time: Option<f64>,
    metric: &str,
) -> Result<Accuracy, Failure> {
    let request = Request {
        scheme,
        tolerance,
        solver,
        p,
        base,
        base_time,
        metric,
        ..Request::plain(method, 1)
    };
    let request = accuracy_request(&request, steps, bands, scales, refinement)?;
    start(mesh, request, |inner| Accuracy { inner })?.wait(py, progress)
}

/// Start `accuracy` in a thread of its own and return the `Job` at once.
///
/// Takes the arguments of `accuracy`, without `progress`; `Job.result` gives the `Accuracy`.
///
/// Raises
/// ------
/// MeshError
///     If an argument cannot be read; what only the work finds out, `Job.result` raises.
#[pyfunction]
#[pyo3(signature = (mesh, method = "m1", steps = None, bands = 5, *, scales = None,
                    refinement = 8, scheme = "extrapolated", tolerance = 1e-3, solver = "auto",
                    p = 3, base = None, base_time = None, metric = "surface"))]
#[expect(
    clippy::too_many_arguments,
    reason = "keyword arguments of a Python function"
)]
pub fn start_accuracy(
    mesh: &Mesh,
    method: &str,
    steps: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = parameters::bands)] bands: usize,
    #[pyo3(from_py_with = parameters::scales)] scales: Option<(f64, f64)>,
    #[pyo3(from_py_with = parameters::refinement)] refinement: usize,
    scheme: &str,
    #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
    solver: &str,
    #[pyo3(from_py_with = parameters::p)] p: u32,
    base: Option<Bound<'_, PyAny>>,
    #[pyo3(from_py_with = parameters::base_time)] base_time: Option<f64>,
    metric: &str,
) -> Result<Job, Failure> {
    let request = Request {
        scheme,
        tolerance,
        solver,
        p,
        base,
        base_time,
        metric,
        ..Request::plain(method, 1)
    };
    let request = accuracy_request(&request, steps, bands, scales, refinement)?;
    let task = start(mesh, request, |inner| -> Convert {
        Box::new(move |py| Ok(Py::new(py, Accuracy { inner })?.into_any()))
    })?;
    Ok(Job::new(task))
}

/// The numbers of steps where none are given.
const STEPS: [usize; 3] = [8, 16, 32];

fn accuracy_request(
    request: &Request,
    steps: Option<&Bound<'_, PyAny>>,
    bands: usize,
    scales: Option<(f64, f64)>,
    refinement: usize,
) -> Result<AccuracyRequest, Failure> {
    let steps = match steps {
        None => STEPS.to_vec(),
        Some(steps) => step_counts(steps)?,
    };
    Ok(AccuracyRequest {
        settings: request.settings()?,
        steps,
        scales,
        bands,
        refinement,
    })
}

/// Numbers of steps, whatever they are.
fn step_counts(steps: &Bound<'_, PyAny>) -> Result<Vec<usize>, Failure> {
    let counts = arrays::indices("steps", steps)?;
    let count = |&count: &i64| {
        usize::try_from(count)
            .map_err(|_| refused(format!("steps must be at least 2, not {count}")))
    };
    counts.iter().map(count).collect()
}

fn start<T: Send + 'static>(
    mesh: &Mesh,
    request: AccuracyRequest,
    wrap: impl FnOnce(method::Accuracy) -> T + Send + 'static,
) -> Result<Task<T>, Failure> {
    let mesh = Arc::clone(&mesh.inner);
    Task::start(move |monitor| method::accuracy(&mesh, &request, monitor.whole()).map(wrap))
}
