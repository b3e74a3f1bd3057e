//! The class `Flow`: the states of a flow, and their spectral transform.

use ndarray::{Array2, Array3};
use numpy::{IntoPyArray, PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyList;
use spectral_tv::flow::{Increment, Trajectory};
use spectral_tv::memory;
use spectral_tv::memory::needs;
use spectral_tv::monitor::Stage;
use spectral_tv::spectral::{SpectralTransform, even_edges};

use crate::arrays;
use crate::error::{Failure, refused};
use crate::job::{Task, guarded};
use crate::parameters;
use crate::pickling::{Parts, Pickled, Writer};
use crate::settings::gains as parse_gains;

/// A flow sampled at N + 1 times, made by `flow` or `decompose_image`, or found in
/// `Decomposition.flow`.
///
/// The components φ_k at the times t_1 … t_{N−1} and the residual R add up to the values that
/// were flowed (Brokman et al. 2024, Eqs. 50 and 53), to rounding, whatever the steps. C is 1 and
/// left out of all shapes where the values were given as (V,). Of an image, V stands for H, W.
#[pyclass(frozen, module = "spectral_tv")]
pub struct Flow {
    transform: SpectralTransform,
    /// Areas of the vertices.
    masses: Vec<f64>,
    layout: Layout,
}

/// In which shape values came, and go back.
#[derive(Debug, Clone)]
pub struct Layout {
    /// (V,), or (H, W) of an image.
    pub places: Vec<usize>,
    /// Whether there was an axis for channels.
    pub has_channels: bool,
}

impl Flow {
    pub fn new(transform: SpectralTransform, masses: Vec<f64>, layout: Layout) -> Self {
        Self {
            transform,
            masses,
            layout,
        }
    }

    /// (V, C) or (K, V, C) in the layout of the values, behind the axes `before`.
    fn arranged<'py>(
        &self,
        array: Bound<'py, PyAny>,
        before: &[usize],
        channels: usize,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut shape = [before, &self.layout.places].concat();
        if self.layout.has_channels {
            shape.push(channels);
        }
        array.call_method1("reshape", (shape,))
    }

    /// (C, V) as (V, C), or as (V,).
    fn per_vertex<'py>(
        &self,
        py: Python<'py>,
        values: &Array2<f64>,
    ) -> Result<Bound<'py, PyAny>, Failure> {
        let array = arrays::per_vertex(py, values.view())?;
        Ok(self.arranged(array.into_any(), &[], values.nrows())?)
    }

    /// (K, V, C), or (K, V).
    fn stack<'py>(&self, py: Python<'py>, values: Array3<f64>) -> PyResult<Bound<'py, PyAny>> {
        let (count, _, channels) = values.dim();
        self.arranged(values.into_pyarray(py).into_any(), &[count], channels)
    }
}

#[pymethods]
impl Flow {
    /// t₀ = 0 < t₁ < … < t_N, (N+1,), length² for shapes.
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
        arrays::array_of(py, self.transform.times())
    }

    /// u(t_k), (N+1, V, C); (N+1, V) if the values were given as (V,).
    #[getter]
    fn states<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyAny>, Failure> {
        let transform = self.transform.clone();
        let task = Task::start(move |monitor| {
            let trajectory = transform.trajectory();
            let (nodes, shape) = (trajectory.times.len(), trajectory.initial().dim());
            arrays::stacked(nodes, shape, trajectory.states(), monitor.whole())
        })?;
        Ok(self.stack(py, task.wait(py, None)?)?)
    }

    /// TV(u(t_k)), (N+1,), unit of the values × length; of the unknowns where those are on edges.
    #[getter]
    fn total_variation<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
        arrays::array_of(py, &self.transform.trajectory().total_variation)
    }

    /// Duality gap of each step as a proximal step of TV, relative to Δt TV at its start, (N,): how far
    /// its energy may be above the least. Its dual field is the one that the step found, or w ∇u
    /// where it found none. 0 for linear flows, and once nothing is left to decay.
    #[getter]
    fn gap<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
        arrays::array_of(py, &self.transform.trajectory().gaps)
    }

    /// S(t_k) = Σ_v M_v |φ_k(v)| for k = 1 … N−1, (N−1,), unit of the values × length².
    #[getter]
    fn spectrum<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
        let spectrum = guarded(py, |stage| {
            claim_functions(&self.transform, stage)?;
            self.transform.spectrum_with(&self.masses, stage)
        });
        Ok(spectrum?.into_pyarray(py))
    }

    /// What is left of the values once every component is removed, (V, C).
    #[getter]
    fn residual<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyAny>, Failure> {
        let residual = guarded(py, |stage| {
            claim_functions(&self.transform, stage)?;
            Ok(self.transform.residual())
        })?;
        self.per_vertex(py, &residual)
    }

    /// Edges from 0 to t_N that cut the components into `count` bands of equal numbers, each
    /// half-way between two times, (count+1,).
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
        Ok(even_edges(self.transform.times(), count)?.into_pyarray(py))
    }

    /// What each band adds to the residual, (K, V, C).
    ///
    /// Parameters
    /// ----------
    /// edges : (K+1,) array
    ///     Increasing times. Edges are 0.2 wide in ln t, so that bands do not depend on the steps.
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
    ) -> Result<Bound<'py, PyAny>, Failure> {
        let edges = arrays::list("edges", edges)?;
        let shape = self.transform.trajectory().initial().dim();
        let transform = self.transform.clone();
        let task = Task::start(move |monitor| {
            let bands = transform.bands(&edges)?;
            arrays::stacked(edges.len() - 1, shape, bands, monitor.whole())
        })?;
        Ok(self.stack(py, task.wait(py, None)?)?)
    }

    /// The values filtered by H: Σ_k H(t_k) φ_k + R (Brokman et al. 2024, Eq. 53), (V, C).
    ///
    /// Parameters
    /// ----------
    /// gains : (N−1,) array or callable
    ///     The values H(t_k) for k = 1 … N−1, or the function H of a time.
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
    ) -> Result<Bound<'py, PyAny>, Failure> {
        let gains = parse_gains(gains, self.transform.component_times())?;
        let values = guarded(py, |stage| {
            claim_functions(&self.transform, stage)?;
            self.transform.filter(&gains)
        })?;
        self.per_vertex(py, &values)
    }

    /// The mean value of a part of the surface at every time, (N+1, C).
    ///
    /// Parameters
    /// ----------
    /// weights : (V,) array of numbers or bools
    ///     How much of each vertex's area counts, 0 or more; True for the vertices of a set.
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     If there is not one weight of 0 or more per vertex, or they give no area at all.
    fn mean<'py>(
        &self,
        py: Python<'py>,
        weights: &Bound<'py, PyAny>,
    ) -> Result<Bound<'py, PyAny>, Failure> {
        // Of an image they may have its shape.
        let weights = match self.layout.places.len() {
            1 => weights.clone(),
            _ => {
                let numpy = py.import("numpy")?;
                numpy.call_method1("ravel", (weights,))?
            }
        };
        let weights = arrays::weights("weights", &weights)?;
        let means = guarded(py, |stage| {
            claim_functions(&self.transform, stage)?;
            self.transform.trajectory().mean(&weights, &self.masses)
        })?;
        let nodes = means.nrows();
        let array = means.into_pyarray(py);
        Ok(match self.layout.has_channels {
            true => array.into_any(),
            false => array.reshape([nodes])?.into_any(),
        })
    }

    /// Draw the spectrum with its bands, as `Decomposition.plot` does.
    #[pyo3(signature = (edges = None, axes = None))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        edges: Option<Bound<'py, PyAny>>,
        axes: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let module = slf.py().import("spectral_tv._plotting")?;
        module.call_method1("plot_spectrum", (slf, edges, axes))
    }

    fn __repr__(&self) -> String {
        let trajectory = self.transform.trajectory();
        format!(
            "Flow({} steps, {} vertices, {} channels)",
            trajectory.times.len() - 1,
            trajectory.vertex_count(),
            trajectory.channel_count()
        )
    }
}

/// Has short work granted what some functions of the transform's take.
pub fn claim_functions(transform: &SpectralTransform, stage: Stage) -> spectral_tv::Result<()> {
    const FUNCTIONS: usize = 8;
    let trajectory = transform.trajectory();
    let vertices = trajectory.vertex_count();
    stage.claim(
        needs::functions(FUNCTIONS * trajectory.channel_count(), vertices as u64),
        &format!("a function on {vertices} vertices"),
        "free some memory",
    )
}

impl Pickled for Flow {
    const NAME: &'static str = "Flow";

    fn write(&self, parts: &Writer<'_>) -> Result<(), Failure> {
        write_trajectory(self.transform.trajectory(), parts)?;
        parts.list("masses", &self.masses)?;
        parts.value("places", &self.layout.places)?;
        parts.value("has_channels", self.layout.has_channels)
    }

    fn read(_py: Python<'_>, parts: &Parts<'_>) -> Result<Self, Failure> {
        let trajectory = read_trajectory(parts)?;
        let masses = parts.list("masses")?;
        let layout = Layout {
            places: parts.value("places")?,
            has_channels: parts.value("has_channels")?,
        };
        let vertices = layout
            .places
            .iter()
            .try_fold(1, |product: usize, &places| product.checked_mul(places));
        let is_right = vertices == Some(trajectory.vertex_count())
            && masses.len() == trajectory.vertex_count()
            && (layout.has_channels || trajectory.channel_count() == 1)
            && masses.iter().all(|mass| *mass >= 0.0 && mass.is_finite());
        match is_right {
            true => Ok(Self::new(
                SpectralTransform::new(trajectory),
                masses,
                layout,
            )),
            false => {
                let message = "the parts of the flow have shapes that do not go together";
                Err(refused(message))
            }
        }
    }
}

/// Writes a flow as it is kept, (C, V) for the first state and each increment.
pub fn write_trajectory(trajectory: &Trajectory, parts: &Writer<'_>) -> Result<(), Failure> {
    let py = parts.py();
    let (increments, mut units) = (PyList::empty(py), Vec::new());
    let units_of_blocks = PyList::empty(py);
    for increment in trajectory.increments() {
        match increment {
            Increment::Double(values) => {
                increments.append(arrays::table_of(py, values.view())?)?;
                units.push(1.0);
            }
            Increment::Single { values, unit } => {
                increments.append(arrays::table_of(py, values.view())?)?;
                units.push(*unit);
            }
            Increment::Short {
                values,
                units: of_blocks,
            } => {
                increments.append(arrays::table_of(py, values.view())?)?;
                units.push(1.0);
                units_of_blocks.append(arrays::table_of(py, of_blocks.view())?)?;
            }
        }
    }
    parts.list("times", &trajectory.times)?;
    parts.matrix("initial", trajectory.initial())?;
    parts.value("increments", increments)?;
    parts.list("units", &units)?;
    parts.value("units_of_blocks", units_of_blocks)?;
    parts.list("total_variation", &trajectory.total_variation)?;
    parts.list("gaps", &trajectory.gaps)?;
    parts.value("is_piecewise_linear", trajectory.is_piecewise_linear())
}

/// Reads it; the dtype of an increment tells in which precision it is kept.
pub fn read_trajectory(parts: &Parts<'_>) -> Result<Trajectory, Failure> {
    let units = parts.list("units")?;
    let written: Vec<Bound<'_, PyAny>> = parts.value("increments")?;
    if units.len() != written.len() {
        let message = "the parts of the flow have numbers that do not go together";
        return Err(refused(message));
    }
    let units_of_blocks: Vec<Bound<'_, PyAny>> = parts.value("units_of_blocks")?;
    let mut units_of_blocks = units_of_blocks.iter();
    let mut increments = memory::vector(written.len(), "a flow", "free some memory")?;
    for (written, &unit) in written.iter().zip(&units) {
        let size: usize = written.getattr("dtype")?.getattr("itemsize")?.extract()?;
        increments.push(match size {
            2 => {
                let of_blocks = units_of_blocks.next().ok_or_else(|| {
                    refused("the flow has increments in 16 bits without their units")
                })?;
                Increment::Short {
                    values: arrays::matrix("increments", written, "int16")?,
                    units: arrays::matrix("units_of_blocks", of_blocks, "float64")?,
                }
            }
            4 => Increment::Single {
                values: arrays::matrix("increments", written, "float32")?,
                unit,
            },
            _ => Increment::Double(arrays::matrix("increments", written, "float64")?),
        });
    }
    let flow = Trajectory::restored(
        parts.list("times")?,
        parts.matrix("initial")?,
        increments,
        parts.list("total_variation")?,
        parts.list("gaps")?,
    )?;
    Ok(match parts.value("is_piecewise_linear")? {
        true => flow.piecewise_linear(),
        false => flow,
    })
}
