//! The class `Decomposition` and the functions that make one.

use std::sync::Arc;

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3};
use pyo3::prelude::*;
use spectral_tv::method;
use spectral_tv::spectral::{SpectralTransform, even_edges};

use crate::arrays;
use crate::error::Failure;
use crate::flow::{Flow, Layout, claim_functions, read_trajectory, write_trajectory};
use crate::job::{Convert, Job, Task, guarded};
use crate::mesh::Mesh;
use crate::parameters;
use crate::pickling::{Parts, Pickled, Reduced, Writer, reduced};
use crate::settings::{Request, gains as parse_gains};

/// A shape split into scales by `decompose`.
///
/// The components φ_k at the times t_1 … t_{N−1} and the residual R add up to the shape
/// (Brokman et al. 2024, Eqs. 50 and 53), to rounding, whatever the steps.
#[pyclass(frozen, module = "spectral_tv")]
pub struct Decomposition {
    pub inner: Arc<method::Decomposition>,
}

#[pymethods]
impl Decomposition {
    /// t₀ = 0 < t₁ < … < t_N, (N+1,), length².
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
        arrays::array_of(py, self.inner.times())
    }

    /// S(t_k) = Σ_v M_v |φ_k(v)| for k = 1 … N−1, (N−1,), length³.
    #[getter]
    fn spectrum<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
        arrays::array_of(py, self.inner.spectrum())
    }

    /// The shape that is left once every component is removed, (V, 3).
    #[getter]
    fn residual<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
        let residual = guarded(py, |stage| {
            claim_functions(self.inner.transform(), stage)?;
            Ok(self.inner.residual())
        })?;
        arrays::per_vertex(py, residual.view())
    }

    /// The flow that was transformed: of the positions, or of M3's displacement.
    #[getter]
    fn flow(&self) -> Result<Flow, Failure> {
        let transform = self.inner.transform().clone();
        let trajectory = transform.trajectory();
        let layout = Layout {
            places: vec![trajectory.vertex_count()],
            has_channels: trajectory.channel_count() > 1,
        };
        let masses = arrays::copied(self.inner.vertex_areas())?;
        Ok(Flow::new(transform, masses, layout))
    }

    /// Edges from 0 to t_N that cut the components into `count` bands of equal numbers, each
    /// half-way between two times; (count+1,), length².
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     If count is 0 or larger than the number of components, N−1.
    fn band_edges<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = parameters::count)] count: usize,
    ) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
        Ok(even_edges(self.inner.times(), count)?.into_pyarray(py))
    }

    /// The displacement that each band adds to the residual, (K, V, 3).
    ///
    /// Parameters
    /// ----------
    /// edges : (K+1,) array
    ///     Increasing times, length²; component k is in [edge_i, edge_{i+1}).
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     If the edges do not increase, or are those of over a million bands.
    /// MemoryError
    ///     If the bands do not fit into what is available.
    fn bands<'py>(
        &self,
        py: Python<'py>,
        edges: &Bound<'py, PyAny>,
    ) -> Result<Bound<'py, PyArray3<f64>>, Failure> {
        let edges = arrays::list("edges", edges)?;
        let shape = (3, self.inner.vertex_areas().len());
        let inner = Arc::clone(&self.inner);
        let task = Task::start(move |monitor| {
            let bands = inner.bands(&edges)?;
            arrays::stacked(edges.len() - 1, shape, bands, monitor.whole())
        })?;
        Ok(task.wait(py, None)?.into_pyarray(py))
    }

    /// The shape filtered by H: Σ_k H(t_k) φ_k + R (Brokman et al. 2024, Eq. 53), (V, 3).
    ///
    /// Parameters
    /// ----------
    /// gains : (N−1,) array or callable
    ///     The values H(t_k) for k = 1 … N−1, or the function H of a time in length².
    ///     1 keeps a component, 0 removes it, more amplifies it.
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     If there is not one finite gain per component.
    fn filter<'py>(
        &self,
        py: Python<'py>,
        gains: &Bound<'py, PyAny>,
    ) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
        let gains = parse_gains(gains, self.inner.component_times())?;
        let shape = guarded(py, |stage| {
            claim_functions(self.inner.transform(), stage)?;
            self.inner.filter(&gains)
        })?;
        arrays::per_vertex(py, shape.view())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> Result<Reduced<'py>, Failure> {
        reduced(py, self)
    }

    /// The decomposition itself: nothing can change it.
    fn __copy__(this: Bound<'_, Self>) -> Bound<'_, Self> {
        this
    }

    /// The decomposition itself.
    fn __deepcopy__<'py>(this: Bound<'py, Self>, _memo: &Bound<'py, PyAny>) -> Bound<'py, Self> {
        this
    }

    fn __repr__(&self) -> String {
        let times = self.inner.times();
        format!(
            "Decomposition({} steps up to t = {:.5e})",
            times.len() - 1,
            times[times.len() - 1]
        )
    }
}

impl Pickled for Decomposition {
    const NAME: &'static str = "Decomposition";

    fn write(&self, parts: &Writer<'_>) -> Result<(), Failure> {
        write_trajectory(self.inner.transform().trajectory(), parts)?;
        parts.list("spectrum", self.inner.spectrum())?;
        parts.list("vertex_areas", self.inner.vertex_areas())?;
        match self.inner.displacement() {
            Some(found) => {
                parts.matrix("base", found.base.view())?;
                parts.matrix("direction", found.direction.view())
            }
            None => {
                parts.value("base", None::<()>)?;
                parts.value("direction", None::<()>)
            }
        }
    }

    fn read(_py: Python<'_>, parts: &Parts<'_>) -> Result<Self, Failure> {
        let base_and_direction = match parts.optional("base")? {
            Some(_) => Some((parts.matrix("base")?, parts.matrix("direction")?)),
            None => None,
        };
        let inner = method::Decomposition::restored(
            SpectralTransform::new(read_trajectory(parts)?),
            base_and_direction,
            parts.list("spectrum")?,
            parts.list("vertex_areas")?,
        )?;
        Ok(Self {
            inner: Arc::new(inner),
        })
    }
}

/// Split the shape of a mesh into scales.
///
/// Parameters
/// ----------
/// mesh : Mesh
/// method : {"m1", "m2", "m3", "naive", "heat", "lb", "displacement"}
///     "m1": shape spectral TV, for surface detail (Brokman et al. 2024, Sec. 7.3).
///     "m2": conformalized P-Laplace, for limbs and head (Sec. 7.4).
///     "m3": directional TV on a smooth base, keeps edges (Sec. 7.5).
///     "naive": TV of each coordinate alone (Sec. 7.2).
///     For comparison: "heat": linear diffusion. "lb": eigenfunctions of the Laplace–Beltrami
///     operator (Vallet and Lévy 2008), each at the time 1/λ; the first component is what the
///     `eigenpairs` do not hold. "displacement": the difference to a smooth base as the only
///     component (Cignoni, Scopigno and Tarini 2005).
/// times : (N+1,) array, optional
///     Increasing from 0, length². Default: `steps` times, evenly spaced at first and then in
///     log t, up to 3e-3 of the area for "m1", "naive" and "heat", 1e-2 for "m2" and 1e-3 for
///     "m3": from skin to hands and feet, to whole limbs, to plates and muscles. For "lb" from
///     half the last 1/λ on, up to 3e-3 of the area or more. None for "displacement".
/// steps : int
///     The number of steps N, where no times are given.
/// progress : callable, optional
///     Called with the fraction done; an exception it raises ends the work.
/// accuracy : float, optional
///     Take as many steps as the bands need to have this error, relative to their size and the
///     mean of five; `steps` is then of no account, and times that are given are cut into more.
///     0.1 is hardly seen, 0.02 is fine. The estimate takes two flows at least, of 12 and 24
///     steps, and each that follows has up to four times the steps of the one before.
/// scheme : {"extrapolated", "lagged", "exact"}
///     How steps take their weights; see `flow`. "exact" is for "naive", "m1" and "m3".
/// tolerance : float
///     Relative duality gap of exact steps, in (0, 1).
/// solver : {"auto", "cholesky", "multigrid"}
///     How the linear systems of steps are solved: by what is faster at the mesh's size, by
///     factorization, or by conjugate gradients with multigrid to 2e-6 of each increment.
///     Exact steps are always solved by factorization.
/// p : {3, 2, 1}
///     The P of "m2". Only 3 is zero-homogeneous.
/// base : (V, 3) array, optional
///     The smooth base of "m3" and "displacement". Default: the mesh under ten steps of
///     `conformal_flow`.
/// base_time : float, optional
///     How far that flow goes, length². Default: 5e-3 of the area.
/// eigenpairs : int
///     How many "lb" uses, the lowest; all of them if the mesh has no more. See `eigenpairs`.
/// metric : {"surface", "base"}
///     Whose metric drives the flow of "m3": the mesh's or its base's. With a flat base a height
///     field is an image, and these are its spectral ATV and its spectral TV (Sec. 9.3).
///
/// Returns
/// -------
/// Decomposition
///
/// Raises
/// ------
/// MeshError
///     If an argument is of the wrong shape, not finite, or out of range; says where.
/// MemoryError
///     If the work takes more than is available, before it starts.
#[pyfunction]
#[pyo3(signature = (mesh, method = "m1", times = None, steps = 32, progress = None, *,
                    accuracy = None, scheme = "extrapolated", tolerance = 1e-3,
                    solver = "auto", p = 3, base = None, base_time = None, eigenpairs = 300,
                    metric = "surface"))]
#[expect(
    clippy::too_many_arguments,
    reason = "keyword arguments of a Python function"
)]
pub fn decompose(
    py: Python<'_>,
    mesh: &Mesh,
    method: &str,
    times: Option<Bound<'_, PyAny>>,
    #[pyo3(from_py_with = parameters::steps)] steps: usize,
    progress: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = parameters::accuracy)] accuracy: Option<f64>,
    scheme: &str,
    #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
    solver: &str,
    #[pyo3(from_py_with = parameters::p)] p: u32,
    base: Option<Bound<'_, PyAny>>,
    #[pyo3(from_py_with = parameters::base_time)] base_time: Option<f64>,
    #[pyo3(from_py_with = parameters::eigenpairs)] eigenpairs: usize,
    metric: &str,
) -> Result<Decomposition, Failure> {
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
    let task = start(mesh, &request, |inner| Decomposition { inner })?;
    task.wait(py, progress)
}

/// Start `decompose` in a thread of its own and return the `Job` at once.
///
/// Takes the arguments of `decompose`, without `progress`; `Job.result` gives the
/// `Decomposition`.
///
/// Raises
/// ------
/// MeshError
///     If an argument cannot be read; what only the work finds out, `Job.result` raises.
#[pyfunction]
#[pyo3(signature = (mesh, method = "m1", times = None, steps = 32, *,
                    accuracy = None, scheme = "extrapolated", tolerance = 1e-3,
                    solver = "auto", p = 3, base = None, base_time = None, eigenpairs = 300,
                    metric = "surface"))]
#[expect(
    clippy::too_many_arguments,
    reason = "keyword arguments of a Python function"
)]
pub fn start_decompose(
    mesh: &Mesh,
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
) -> Result<Job, Failure> {
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
    let task = start(mesh, &request, |inner| -> Convert {
        Box::new(move |py| Ok(Py::new(py, Decomposition { inner })?.into_any()))
    })?;
    Ok(Job::new(task))
}

/// Starts the work in a thread; `wrap` makes of its result what the thread hands over.
fn start<T: Send + 'static>(
    mesh: &Mesh,
    request: &Request,
    wrap: impl FnOnce(Arc<method::Decomposition>) -> T + Send + 'static,
) -> Result<Task<T>, Failure> {
    let settings = request.settings()?;
    let mesh = Arc::clone(&mesh.inner);
    Task::start(move |monitor| {
        method::decompose(&mesh, &settings, monitor.whole()).map(|inner| wrap(Arc::new(inner)))
    })
}
