//! The functions that decompose an image.

use pyo3::prelude::*;
use spectral_tv::image::{self, Image, Metric, Settings};
use spectral_tv::spectral::SpectralTransform;

use crate::arrays;
use crate::error::{Failure, refused};
use crate::flow::{Flow, Layout};
use crate::job::{Convert, Job, Task};
use crate::parameters;
use crate::settings::{scheme as parse_scheme, solver as parse_solver};

/// Split an image into bands by spectral TV, its channels together.
///
/// Each pixel cell counts as the mean over its four corners of √(dx² + dy²), so that turning or
/// mirroring the image changes nothing. Lengths are in pixels.
///
/// Parameters
/// ----------
/// image : (H, W) or (H, W, C) array of numbers
///     Row by row, in any unit and encoding; the values are taken as they are. The C channels are
///     coupled; to keep colors, decompose the luminance and add what it changes to all channels.
/// metric : {"flat", "surface"}
///     "flat": the plane's, which is spectral TV of images. "surface": that of the image's graph
///     (x, y, s f), which is spectral ATV (Brokman et al. 2024, Sec. 9.3): on it steep places have
///     more area and change more slowly, so that strong detail outlasts faint detail by more.
/// times : (N+1,) array, optional
///     Increasing from 0, value × pixel. In the plane a disc of the radius r that stands out by h
///     is gone at t = h r/2. Default: `steps` times, evenly spaced at first and then in log t,
///     from what a spot takes that is a tenth of a pixel wide and stands out by the image's whole
///     contrast, to one that is a quarter of the shorter side wide.
/// steps : int
///     The number of steps N, where no times are given.
/// progress : callable, optional
///     Called with the fraction done; an exception it raises ends the work.
/// height : float
///     How high the graph of "surface" is from the least to the greatest value, in pixels.
/// scheme : {"extrapolated", "lagged", "exact"}
///     How steps take their weights; see `flow`.
/// tolerance : float
///     Relative duality gap of exact steps, in (0, 1).
/// solver : {"auto", "cholesky", "multigrid"}
///     How the linear systems of steps are solved; see `decompose`.
///
/// Returns
/// -------
/// Flow
///     Its `states` are (N+1, H, W, C), its `bands` (K, H, W, C), its `residual` and what `filter`
///     returns (H, W, C); without C where the image is (H, W).
///
/// Raises
/// ------
/// MeshError
///     If an argument is of the wrong shape, not finite, or out of range; says where.
/// MemoryError
///     If the work takes more than is available, before it starts.
#[pyfunction]
#[pyo3(signature = (image, metric = "flat", times = None, steps = 32, progress = None, *,
                    height = 32.0, scheme = "extrapolated", tolerance = 1e-3, solver = "auto"))]
#[expect(
    clippy::too_many_arguments,
    reason = "keyword arguments of a Python function"
)]
pub fn decompose_image(
    py: Python<'_>,
    image: &Bound<'_, PyAny>,
    metric: &str,
    times: Option<Bound<'_, PyAny>>,
    #[pyo3(from_py_with = parameters::steps)] steps: usize,
    progress: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = parameters::height)] height: f64,
    scheme: &str,
    #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
    solver: &str,
) -> Result<Flow, Failure> {
    let settings = Settings {
        metric: parse_metric(metric, height)?,
        times: read_times(times)?,
        steps,
        scheme: parse_scheme(scheme, tolerance)?,
        solver: parse_solver(solver)?,
    };
    start(image, settings, |flow| flow)?.wait(py, progress)
}

/// Start `decompose_image` in a thread of its own and return the `Job` at once.
///
/// Takes the arguments of `decompose_image`, without `progress`; `Job.result` gives the `Flow`.
///
/// Raises
/// ------
/// MeshError
///     If an argument cannot be read; what only the work finds out, `Job.result` raises.
#[pyfunction]
#[pyo3(signature = (image, metric = "flat", times = None, steps = 32, *,
                    height = 32.0, scheme = "extrapolated", tolerance = 1e-3, solver = "auto"))]
#[expect(
    clippy::too_many_arguments,
    reason = "keyword arguments of a Python function"
)]
pub fn start_decompose_image(
    image: &Bound<'_, PyAny>,
    metric: &str,
    times: Option<Bound<'_, PyAny>>,
    #[pyo3(from_py_with = parameters::steps)] steps: usize,
    #[pyo3(from_py_with = parameters::height)] height: f64,
    scheme: &str,
    #[pyo3(from_py_with = parameters::tolerance)] tolerance: f64,
    solver: &str,
) -> Result<Job, Failure> {
    let settings = Settings {
        metric: parse_metric(metric, height)?,
        times: read_times(times)?,
        steps,
        scheme: parse_scheme(scheme, tolerance)?,
        solver: parse_solver(solver)?,
    };
    let task = start(image, settings, |flow| -> Convert {
        Box::new(move |py| Ok(Py::new(py, flow)?.into_any()))
    })?;
    Ok(Job::new(task))
}

fn parse_metric(metric: &str, height: f64) -> Result<Metric, Failure> {
    let refuse = |message: String| Err(refused(message));
    match metric {
        "flat" => Ok(Metric::Flat),
        "surface" if height > 0.0 && height <= 1e100 => Ok(Metric::Surface { height }),
        "surface" => refuse(format!(
            "height must be above 0 and at most 1e100, not {height:?}"
        )),
        other => refuse(format!(
            "metric must be \"flat\" or \"surface\", not {other:?}"
        )),
    }
}

fn read_times(times: Option<Bound<'_, PyAny>>) -> Result<Option<Vec<f64>>, Failure> {
    times.map(|times| arrays::list("times", &times)).transpose()
}

/// Starts the work in a thread; `wrap` makes of its result what the thread hands over.
fn start<T: Send + 'static>(
    image: &Bound<'_, PyAny>,
    settings: Settings,
    wrap: impl FnOnce(Flow) -> T + Send + 'static,
) -> Result<Task<T>, Failure> {
    let (values, [rows, columns], has_channels) = arrays::pixels("image", image)?;
    let image = Image {
        values,
        rows,
        columns,
    };
    Task::start(move |monitor| {
        let (flow, areas) = image::decompose_image(&image, &settings, monitor.whole())?;
        let layout = Layout {
            places: vec![rows, columns],
            has_channels,
        };
        Ok(wrap(Flow::new(SpectralTransform::new(flow), areas, layout)))
    })
}
