//! From an image to the flow of its pixels.

use ndarray::{Array2, Axis};

use crate::discretization::Discretization;
use crate::error::{ArgumentError, Result, has_usable_size};
use crate::flow::{TotalVariation, Trajectory};
use crate::image::grid::{COVER, Metric, TRIANGLES, grid};
use crate::memory::needs;
use crate::method::{Scheme, graded_times, run_flow};
use crate::monitor::Stage;
use crate::solver::Solver;

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
#[derive(Debug, Clone)]
pub struct Settings {
    /// What lengths are.
    pub metric: Metric,
    /// N + 1 times from 0, value × pixel; `None`: graded ones.
    pub times: Option<Vec<f64>>,
    /// Number of steps N, where no times are given.
    pub steps: usize,
    /// How steps are taken.
    pub scheme: Scheme,
    /// How linear systems are solved.
    pub solver: Solver,
}

/// Runs the TV flow of an image, its channels coupled; returns it with the area of every pixel,
/// in pixels. In the plane a disc of the radius r falls at the rate 2/r; so one that stands out
/// by h is gone at t = h r/2.
///
/// # Errors
/// If the image has no grid or a value that is not finite, or as [`run_flow`].
pub fn decompose_image(
    image: &Image,
    settings: &Settings,
    stage: Stage,
) -> Result<(Trajectory, Vec<f64>)> {
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
    let mesh = grid(&image.values, rows, columns, contrast, settings.metric)?;
    let operators = Discretization::new(&mesh, stage)?;
    let law = TotalVariation::starting_at(&operators, image.values.view())?;
    let (scheme, solver) = (settings.scheme, settings.solver);
    let values = image.values.clone();
    let mut flow = run_flow(&operators, &law, scheme, values, &times, solver, stage)?;
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
    let is_iterated = settings
        .scheme
        .is_iterated(settings.solver, pixels, channels);
    let size = needs::Size::new(pixels, triangles);
    needs::flow(size, channels, steps, is_iterated).saturating_add(needs::mesh(pixels, triangles))
}
