//! The class `Estimate` and the function that makes one.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use spectral_tv::memory;
use spectral_tv::method::{decomposition_duration, decomposition_memory};

use crate::error::Failure;
use crate::job::guarded;
use crate::mesh::Mesh;
use crate::parameters;
use crate::pickling::{Parts, Pickled, Reduced, Writer, reduced};
use crate::settings::Request;

/// What a decomposition takes, told by `estimate`.
#[pyclass(frozen, module = "spectral_tv")]
pub struct Estimate {
    bytes: u64,
    available: Option<u64>,
    seconds: f64,
}

#[pymethods]
impl Estimate {
    /// Memory at the peak, beside that of the mesh; within a half of it.
    #[getter]
    fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Memory that this process could take when this was estimated: what is free, and what the
    /// limits of a container, a cluster's job or the process leave. None where the system does not
    /// tell.
    #[getter]
    fn available(&self) -> Option<u64> {
        self.available
    }

    /// Whether the first is not more than the second, so that `decompose` would start.
    #[getter]
    fn fits(&self) -> bool {
        self.available
            .is_none_or(|available| self.bytes <= available)
    }

    /// Time to wait: from half to twice as long on an idle machine, by the threads that
    /// `set_threads` and `use_threads` allow.
    #[getter]
    fn seconds(&self) -> f64 {
        self.seconds
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> Result<Reduced<'py>, Failure> {
        reduced(py, self)
    }

    /// The estimate itself: nothing can change it.
    fn __copy__(this: Bound<'_, Self>) -> Bound<'_, Self> {
        this
    }

    /// The estimate itself.
    fn __deepcopy__<'py>(this: Bound<'py, Self>, _memo: &Bound<'py, PyAny>) -> Bound<'py, Self> {
        this
    }

    fn __repr__(&self) -> String {
        format!("Estimate({} bytes, {:.1} s)", self.bytes, self.seconds)
    }
}

impl Pickled for Estimate {
    const NAME: &'static str = "Estimate";

    fn write(&self, parts: &Writer<'_>) -> Result<(), Failure> {
        parts.value("bytes", self.bytes)?;
        parts.value("available", self.available)?;
        parts.value("seconds", self.seconds)
    }

    fn read(_py: Python<'_>, parts: &Parts<'_>) -> Result<Self, Failure> {
        let available = parts.optional("available")?;
        Ok(Self {
            bytes: parts.value("bytes")?,
            available: available.map(|bytes| bytes.extract()).transpose()?,
            seconds: parts.value("seconds")?,
        })
    }
}

/// Estimate what `decompose` takes with the same arguments. It refuses by itself what does not fit.
///
/// The first call times a small flow, for some hundredths of a second.
///
/// Parameters
/// ----------
/// mesh : Mesh or int
///     A mesh, or the number of vertices of one that has twice as many triangles.
/// method, times, steps, accuracy, scheme, tolerance, solver, p, base, base_time, eigenpairs, metric
///     As `decompose` takes them. Where an accuracy decides on the steps, the estimate is of the
///     first two flows, the least that it takes.
///
/// Returns
/// -------
/// Estimate
///
/// Raises
/// ------
/// MeshError
///     If an argument cannot be read.
#[pyfunction]
#[pyo3(signature = (mesh, method = "m1", times = None, steps = 32, *,
                    accuracy = None, scheme = "extrapolated", tolerance = 1e-3,
                    solver = "auto", p = 3, base = None, base_time = None, eigenpairs = 300,
                    metric = "surface"))]
#[expect(
    clippy::too_many_arguments,
    reason = "keyword arguments of a Python function"
)]
pub fn estimate(
    py: Python<'_>,
    mesh: &Bound<'_, PyAny>,
    method: &str,
    times: Option<Bound<'_, PyAny>>,
    #[pyo3(from_py_with = parameters::steps)] steps: usize,
    #[pyo3(from_py_with = parameters::accuracy)] accuracy: Option<f64>,
    scheme: &str,
    #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
    solver: &str,
    #[pyo3(from_py_with = parameters::p)] p: u32,
    base: Option<Bound<'_, PyAny>>,
    #[pyo3(from_py_with = parameters::base_time)] base_time: Option<f64>,
    #[pyo3(from_py_with = parameters::eigenpairs)] eigenpairs: usize,
    metric: &str,
) -> Result<Estimate, Failure> {
    let request = Request {
        method,
        times,
        steps,
        accuracy,
        scheme,
        tolerance,
        solver,
        p,
        base,
        base_time,
        eigenpairs,
        metric,
    };
    let settings = request.settings()?;
    let (vertices, triangles) = size(mesh)?;
    let seconds = guarded(py, |_| {
        decomposition_duration(vertices, triangles, &settings)
    })?;
    Ok(Estimate {
        bytes: decomposition_memory(vertices, triangles, &settings),
        available: memory::available(),
        seconds,
    })
}

/// Numbers of vertices and triangles.
fn size(mesh: &Bound<'_, PyAny>) -> PyResult<(usize, usize)> {
    if let Ok(mesh) = mesh.cast::<Mesh>() {
        let inner = &mesh.get().inner;
        return Ok((inner.vertex_count(), inner.triangles().len()));
    }
    let vertices: usize = mesh.extract().map_err(|_| {
        PyTypeError::new_err("mesh must be a Mesh or a number of vertices, 0 or more")
    })?;
    Ok((vertices, vertices.saturating_mul(2)))
}
