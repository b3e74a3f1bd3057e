//! The class `Decomposition` and the function that starts to make one.

use std::sync::Arc;

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use spectral_tv::mesh::TriangleMesh;
use spectral_tv::method::{self, Displacement};
use spectral_tv::monitor::Stage;
use spectral_tv::spectral::{SpectralTransform, even_edges};

use crate::arrays;
use crate::error::Failure;
use crate::flow::{Flow, Layout, claim_functions, read_trajectory, write_trajectory};
use crate::job::{Job, Task, guarded};
use crate::mesh::Mesh;
use crate::parameters;
use crate::pickling::{Parts, Pickled, Writer};
use crate::settings::{gains as parse_gains, settings};

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

    /// The mesh whose shape was split.
    #[getter]
    fn mesh(&self) -> Mesh {
        let inner = Arc::new(self.inner.mesh().clone());
        Mesh { inner }
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
    ///     Increasing times, length². An edge is 0.2 wide in ln t, so that bands depend on the flow
    ///     and not on its steps. With "lb" and "displacement", whose components lie at their times,
    ///     component k is in [edge_i, edge_{i+1}).
    /// keep_limbs : float
    ///     0: bands as they are. k > 0: at each vertex, what vanishes later than about r²/k stays in the
    ///     residual, for the `thickness` r of the shape there. So low-pass keeps limbs whole, and bands
    ///     have no hems around them. 1 suits characters with "m1"; 2 keeps more, 0.5 exaggerates more.
    ///     Bands then overlap a little in time. The residual is the shape without all bands.
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     If the edges do not increase, or are those of over a million bands, or keep_limbs is negative.
    /// MemoryError
    ///     If the bands do not fit into what is available.
    #[pyo3(signature = (edges, keep_limbs = 0.0))]
    fn bands<'py>(
        &self,
        py: Python<'py>,
        edges: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = parameters::keep_limbs)] keep_limbs: f64,
    ) -> Result<Bound<'py, PyArray3<f64>>, Failure> {
        let edges = arrays::list("edges", edges)?;
        let shape = (3, self.inner.vertex_areas().len());
        let inner = Arc::clone(&self.inner);
        let task = Task::start(move |monitor| {
            let (count, stage) = (edges.len().saturating_sub(1), monitor.whole());
            let bands = inner.bands_keeping_limbs_with(&edges, keep_limbs, stage)?;
            arrays::stacked(count, shape, bands, stage)
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
    /// keep_limbs : float
    ///     As in `bands`: what it leaves in the residual is kept.
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     If there is not one finite gain per component, or keep_limbs is negative.
    #[pyo3(signature = (gains, keep_limbs = 0.0))]
    fn filter<'py>(
        &self,
        py: Python<'py>,
        gains: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = parameters::keep_limbs)] keep_limbs: f64,
    ) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
        let gains = parse_gains(gains, self.inner.component_times())?;
        let inner = Arc::clone(&self.inner);
        let task = Task::start(move |monitor| {
            let stage = monitor.whole();
            claim_functions(inner.transform(), stage)?;
            inner.filter_keeping_limbs_with(&gains, keep_limbs, stage)
        })?;
        let shape = task.wait(py, None)?;
        arrays::per_vertex(py, shape.view())
    }

    /// Draw the spectrum with its bands, by Matplotlib.
    ///
    /// Parameters
    /// ----------
    /// edges : (K+1,) array, optional
    ///     Where bands begin and end, length². Default: those of five bands by `band_edges`.
    /// axes : matplotlib.axes.Axes, optional
    ///     What is drawn into. Default: the current ones.
    ///
    /// Returns
    /// -------
    /// matplotlib.axes.Axes
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     If there is no Matplotlib: the extra `plot` brings it.
    /// MeshError
    ///     If the edges do not increase, or there are no components.
    #[pyo3(signature = (edges = None, axes = None))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        edges: Option<Bound<'py, PyAny>>,
        axes: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let module = slf.py().import("spectral_tv._plotting")?;
        module.call_method1("plot_spectrum", (slf, edges, axes))
    }

    /// Show the mesh with a slider for each band, by PyVista: in a window, or in a notebook.
    ///
    /// At −1 a band is gone, at 0 nothing changes, at 1 it is doubled.
    ///
    /// Parameters
    /// ----------
    /// edges : (K+1,) array, optional
    ///     Where bands begin and end, length². Default: those of five bands by `band_edges`.
    /// keep_limbs : float
    ///     As in `bands`.
    /// plotter : pyvista.Plotter, optional
    ///     What mesh and sliders are added to, without showing it. Default: a new one, which is shown.
    ///
    /// Returns
    /// -------
    /// object
    ///     The plotter that was given, or what `pyvista.Plotter.show` returns.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     If there is no PyVista: the extra `pyvista` brings it.
    /// MeshError, MemoryError
    ///     As `bands` does, and if there are no components.
    #[pyo3(signature = (edges = None, keep_limbs = 0.0, plotter = None))]
    fn show<'py>(
        slf: &Bound<'py, Self>,
        edges: Option<Bound<'py, PyAny>>,
        #[pyo3(from_py_with = parameters::keep_limbs)] keep_limbs: f64,
        plotter: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let module = slf.py().import("spectral_tv._viewing")?;
        module.call_method1("show", (slf, edges, keep_limbs, plotter))
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
        parts.value("mesh", self.mesh())?;
        match self.inner.displacement() {
            Some(found) => {
                parts.matrix("base", found.base.view())?;
                match &found.direction {
                    Some(direction) => parts.matrix("direction", direction.view()),
                    None => parts.value("direction", None::<()>),
                }
            }
            None => {
                parts.value("base", None::<()>)?;
                parts.value("direction", None::<()>)
            }
        }
    }

    fn read(_py: Python<'_>, parts: &Parts<'_>) -> Result<Self, Failure> {
        let part = |name| match parts.optional(name)? {
            None => Ok::<_, Failure>(None),
            Some(_) => parts.matrix(name).map(Some),
        };
        let (base, direction) = (part("base")?, part("direction")?);
        let displacement = base.map(|base| Displacement { base, direction });
        let mesh: Bound<'_, Mesh> = parts.value("mesh")?;
        let inner = method::Decomposition::restored(
            SpectralTransform::new(read_trajectory(parts)?),
            displacement,
            parts.list("spectrum")?,
            parts.list("vertex_areas")?,
            TriangleMesh::clone(&mesh.get().inner),
        )?;
        Ok(Self {
            inner: Arc::new(inner),
        })
    }
}

#[pyfunction]
pub fn start_decompose(mesh: &Mesh, options: &Bound<'_, PyDict>) -> Result<Job, Failure> {
    let settings = settings(options)?;
    let mesh = Arc::clone(&mesh.inner);
    let work = move |stage: Stage| method::decompose_with(&mesh, &settings, stage);
    Job::start(work, |py, split| {
        let inner = Arc::new(split);
        Ok(Decomposition { inner }.into_bound_py_any(py)?)
    })
}
