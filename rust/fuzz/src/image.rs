//! Images.

use arbitrary::Arbitrary;
use ndarray::Array2;
use spectral_tv::flow::Stepping;
use spectral_tv::image::{Image, Metric, Settings, decompose_image};
use spectral_tv::spectral::SpectralTransform;

use crate::number::{number, numbers, times};
use crate::scales::stepping;
use crate::{assert_finite, largest, unless_refused};

/// An image of few pixels.
#[derive(Debug, Arbitrary)]
pub struct Pixels {
    /// Repeated to fill all pixels.
    #[arbitrary(with = numbers)]
    values: Vec<f64>,
    rows: u8,
    columns: u8,
    channels: u8,
    #[arbitrary(with = number)]
    height: f64,
    is_flat: bool,
    #[arbitrary(with = times)]
    times: Vec<f64>,
    has_times: bool,
    steps: u8,
    #[arbitrary(with = stepping)]
    stepping: Stepping,
}

impl Pixels {
    pub fn run(&self) {
        let (rows, columns) = (usize::from(self.rows % 8), usize::from(self.columns % 8));
        let dimensions = (usize::from(self.channels % 5), rows * columns);
        let mut filling = self.values.iter().copied().cycle();
        let image = Image {
            values: Array2::from_shape_simple_fn(dimensions, || filling.next().unwrap_or(1.0)),
            rows,
            columns,
        };
        let settings = Settings {
            metric: match self.is_flat {
                true => Metric::Flat,
                false => Metric::Surface,
            },
            height: self.height,
            times: self.has_times.then(|| self.times.clone()),
            steps: usize::from(self.steps % 7),
            stepping: self.stepping,
        };
        let outcome = decompose_image(&image, &settings);
        let Some((flow, areas)) = unless_refused(outcome) else {
            return;
        };
        assert_finite("areas", &areas);
        assert_finite("TV", &flow.total_variation);
        let transform = SpectralTransform::new(flow);
        let ones = vec![1.0; transform.component_times().len()];
        let parts = (0..ones.len()).map(|k| largest(&transform.component(k)));
        let size = parts.fold(
            largest(&image.values).max(largest(&transform.residual())),
            f64::max,
        );
        let whole = transform.filter(&ones).expect("a gain each");
        assert_finite("image", &whole);
        let error = largest(&(whole - &image.values));
        assert!(error <= 1e-12 * size, "all-pass: {error:e} of {size:e}");
    }
}
