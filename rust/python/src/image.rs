//! The function that starts to decompose an image.

use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use spectral_tv::image::{self, Image, Metric, Settings};
use spectral_tv::monitor::Stage;
use spectral_tv::spectral::SpectralTransform;

use crate::arrays;
use crate::error::Failure;
use crate::flow::{Flow, Layout};
use crate::job::Job;
use crate::parameters;
use crate::settings::{named, stepping};

#[pyfunction]
pub fn start_decompose_image(
    image: &Bound<'_, PyAny>,
    #[pyo3(from_py_with = named)] metric: Metric,
    times: Option<Bound<'_, PyAny>>,
    #[pyo3(from_py_with = parameters::steps)] steps: usize,
    #[pyo3(from_py_with = parameters::height)] height: f64,
    options: &Bound<'_, PyDict>,
) -> Result<Job, Failure> {
    let settings = Settings {
        metric,
        height,
        times: times
            .map(|times| arrays::list("times", &times))
            .transpose()?,
        steps,
        stepping: stepping(options)?,
    };
    settings.check()?;
    let (values, [rows, columns], has_channels) = arrays::pixels("image", image)?;
    let image = Image {
        values,
        rows,
        columns,
    };
    let work = move |stage: Stage| image::decompose_image_with(&image, &settings, stage);
    Job::start(work, move |py, (flow, areas)| {
        let layout = Layout {
            places: vec![rows, columns],
            has_channels,
        };
        Ok(Flow::new(SpectralTransform::new(flow), areas, layout).into_bound_py_any(py)?)
    })
}
