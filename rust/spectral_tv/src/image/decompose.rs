//! Decomposes an image: from its pixels to their flow.

use ndarray::{Array2, Axis};

use crate::discretization::Discretization;
use crate::error::{ArgumentError, Result, has_usable_size};
use crate::flow::{Stepping, TotalVariation, Trajectory};
use crate::image::grid::{COVER, Metric, TRIANGLES, grid};
use crate::memory::needs;
use crate::method::graded_times;
use crate::monitor::{Monitor, Stage};

/// Default times run from when a spot of this width in pixels is gone that stands out by the
/// whole contrast, as are fainter ones that are larger …
const FINEST: f64 = 0.1;
/// … to when one is gone of this width, relative to the shorter side.
const LARGEST: f64 = 0.25;

/// An image: C channels at rows × columns pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// (C, rows × columns), row by row.
    pub values: Array2<f64>,
    /// Pixels from top to bottom.
    pub rows: usize,
    /// Pixels from left to right.
    pub columns: usize,
}

impl Image {
    /// How far the values are apart, over all channels together; 1 where all are the same.
    pub fn contrast(&self) -> f64 {
        let range = |channel: ndarray::ArrayView1<f64>| {
            let low = channel.iter().copied().fold(f64::INFINITY, f64::min);
            let high = channel.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            high - low
        };
        let squares = self.values.axis_iter(Axis(0)).map(|c| range(c).powi(2));
        let contrast = squares.sum::<f64>().sqrt();
        if contrast > 0.0 { contrast } else { 1.0 }
    }

    fn check(&self) -> Result<()> {
        match self
            .values
            .indexed_iter()
            .find(|(_, v)| !has_usable_size(**v))
        {
            Some(((channel, pixel), value)) => Err(ArgumentError::non_finite("image", value)
                .called(format!(
                    "the pixel in row {}, column {}, channel {channel},",
                    pixel / self.columns,
                    pixel % self.columns
                ))
                .into()),
            None => Ok(()),
        }
    }
}

/// What to decompose an image by.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// What lengths are.
    pub metric: Metric,
    /// How high the graph is: s times the contrast, in pixels.
    pub height: f64,
    /// N + 1 times from 0, value × pixel; `None`: graded ones.
    pub times: Option<Vec<f64>>,
    /// Number of steps N, where no times are given.
    pub steps: usize,
    /// How steps are taken.
    pub stepping: Stepping,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            metric: Metric::default(),
            height: 32.0,
            times: None,
            steps: 32,
            stepping: Stepping::default(),
        }
    }
}

impl Settings {
    /// Refuses settings that make no sense, whatever the image.
    ///
    /// # Errors
    /// If a number is out of range.
    pub fn check(&self) -> Result<()> {
        self.stepping.check()?;
        match self.metric {
            Metric::Surface if !(self.height > 0.0 && has_usable_size(self.height)) => {
                let rule = "must be above 0 and at most 1e100";
                Err(ArgumentError::value("height", rule, format_args!("{:?}", self.height)).into())
            }
            _ => Ok(()),
        }
    }

    /// By how much values are multiplied to be heights.
    fn scale(&self, contrast: f64) -> f64 {
        match self.metric {
            Metric::Flat => 0.0,
            Metric::Surface => self.height / contrast,
        }
    }
}

/// Runs the TV flow of an image, its channels coupled; returns it with the area of every pixel,
/// in pixels. In the plane a disc of the radius r falls at the rate 2/r; so one that stands out
/// by h is gone at t = h r/2.
///
/// ```
/// use spectral_tv::image::{Image, Settings, decompose_image};
/// use spectral_tv::ndarray::Array2;
///
/// let values = Array2::from_shape_fn((1, 12), |(_, pixel)| f64::from(u8::from(pixel == 5)));
/// let image = Image { values, rows: 3, columns: 4 };
/// let (flow, areas) = decompose_image(&image, &Settings::default())?;
/// assert_eq!((flow.vertex_count(), areas.len()), (12, 12));
/// # Ok::<(), spectral_tv::Error>(())
/// ```
///
/// # Errors
/// If the image has no grid or a value that is not finite, or as [`Stepping::run`].
pub fn decompose_image(image: &Image, settings: &Settings) -> Result<(Trajectory, Vec<f64>)> {
    decompose_image_with(image, settings, Monitor::new().whole())
}

/// [`decompose_image`], watched: `stage` tells how far it is, and cancels it.
///
/// # Errors
/// As [`decompose_image`], or [`crate::Error::Cancelled`].
pub fn decompose_image_with(
    image: &Image,
    settings: &Settings,
    stage: Stage,
) -> Result<(Trajectory, Vec<f64>)> {
    settings.check()?;
    image.check()?;
    let contrast = image.contrast();
    let (rows, columns) = (image.rows, image.columns);
    let times = match &settings.times {
        Some(times) => times.clone(),
        None => {
            let extinction = |width: f64| contrast * width / 4.0;
            let largest = (LARGEST * rows.min(columns) as f64).max(2.0 * FINEST);
            graded_times(extinction(FINEST), extinction(largest), settings.steps)?
        }
    };
    stage.require(
        memory(image, settings, times.len().saturating_sub(1)),
        &format!("decomposing an image of {columns} × {rows} pixels"),
        "take fewer steps, or a smaller image",
    )?;
    let mesh = grid(&image.values, rows, columns, settings.scale(contrast))?;
    let operators = Discretization::new_with(&mesh, stage)?;
    let law = TotalVariation::default().starting_at(&operators, image.values.view())?;
    let values = image.values.clone();
    let mut flow = settings
        .stepping
        .run_with(&operators, &law, values, &times, stage)?;
    for variation in &mut flow.total_variation {
        *variation /= COVER;
    }
    let areas = operators.masses().iter().map(|mass| mass / COVER).collect();
    Ok((flow, areas))
}

/// Bytes that it takes: the grid, and its flow of so many steps.
fn memory(image: &Image, settings: &Settings, steps: usize) -> u64 {
    let (channels, pixels) = image.values.dim();
    let triangles = pixels.saturating_mul(TRIANGLES);
    let solved = settings.stepping.solved(pixels, channels);
    let size = needs::Size::new(pixels, triangles);
    needs::flow(size, channels, steps, solved).saturating_add(needs::mesh(pixels, triangles))
}
