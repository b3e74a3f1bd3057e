//! The number of steps that a given accuracy of the bands needs.

use ndarray::Array2;

use crate::error::{ArgumentError, Result};
use crate::flow::Trajectory;
use crate::method::band_errors::{lengths, norm};
use crate::monitor::Stage;
use crate::spectral::{band_between, even_edges};

/// Steps of the first flow, where no times are given.
pub(super) const FEWEST_STEPS: usize = 12;
/// Steps beyond which an accuracy is refused.
const MOST_STEPS: usize = 2000;
/// Bands that are compared.
const BANDS: usize = 5;
/// Size of a band relative to the largest, below which its error counts as if it were so large:
/// shapes may have no detail of a scale.
const NEGLIGIBLE: f64 = 0.02;
/// Order at which errors of bands are taken to fall with the step, a cautious one for real meshes,
/// whose features go extinct at times that no step meets.
const ORDER: f64 = 1.2;
/// Steps of a flow over those of the one before, least and most.
const REFINEMENT: (f64, f64) = (1.5, 4.0);
/// Share of what remains of the progress that is given to the next flow.
const SHARE: f64 = 0.4;

/// Runs flows with more and more steps until the bands of the last two tell that the mean error
/// of the last one's is `accuracy`, relative to the bands: Richardson's estimate
/// |b_n − b_m|/((m/n)^q − 1) for n < m steps and order q.
///
/// `masses` are those of the vertices. `flow` runs through times that `times` gives for a number of steps, of which there are
/// `fewest` at first.
///
/// # Errors
/// If `accuracy` takes too many steps; or as `flow` and `times`.
pub(super) fn adapted(
    masses: &[f64],
    accuracy: f64,
    fewest: usize,
    times: impl Fn(usize) -> Result<Vec<f64>>,
    flow: impl Fn(&[f64], Stage) -> Result<Trajectory>,
    stage: Stage,
) -> Result<Trajectory> {
    let edges = even_edges(&times(fewest.max(FEWEST_STEPS))?, BANDS)?;
    let mut done = 0.0;
    let mut run = |steps: usize| -> Result<(Trajectory, Vec<Array2<f64>>)> {
        let until = done + SHARE * (1.0 - done);
        let trajectory = flow(&times(steps)?, stage.stage(done, until))?;
        done = until;
        let bands = edges
            .windows(2)
            .map(|edge| band_between(&trajectory, [edge[0], edge[1]]));
        let bands = bands.collect();
        Ok((trajectory, bands))
    };
    let mut steps = fewest;
    let (_, mut before) = run(steps)?;
    let mut next = 2 * steps;
    loop {
        let (trajectory, bands) = run(next)?;
        let change = change(&before, &bands, masses);
        let gain = (next as f64 / steps as f64).powf(ORDER) - 1.0;
        let error = change / gain;
        if error <= accuracy {
            stage.report(1.0)?;
            return Ok(trajectory);
        }
        let wanted = (error / accuracy).powf(ORDER.recip());
        let factor = wanted.clamp(REFINEMENT.0, REFINEMENT.1);
        (steps, before) = (next, bands);
        next = (factor * steps as f64).ceil() as usize;
        if next > MOST_STEPS {
            return Err(ArgumentError::contradiction(
                "accuracy",
                &[],
                format!("accuracy {accuracy} takes more than {MOST_STEPS} steps; {steps} give {error:.1e}"),
            ).into());
        }
    }
}

/// The mean over bands of ‖`before` − `after`‖/‖`after`‖.
fn change(before: &[Array2<f64>], after: &[Array2<f64>], masses: &[f64]) -> f64 {
    let sizes: Vec<f64> = after
        .iter()
        .map(|band| norm(&lengths(band), masses))
        .collect();
    let largest = sizes
        .iter()
        .fold(f64::MIN_POSITIVE, |max, size| max.max(*size));
    let bands = before.iter().zip(after).zip(&sizes);
    let changes = bands.map(|((before, after), size)| {
        norm(&lengths(&(before - after)), masses) / size.max(NEGLIGIBLE * largest)
    });
    changes.sum::<f64>() / sizes.len() as f64
}

/// `times` with every step cut into equal parts, so that there are at least `steps`.
pub(super) fn subdivided(times: &[f64], steps: usize) -> Vec<f64> {
    let parts = steps.div_ceil(times.len() - 1);
    let steps = times.windows(2).flat_map(|step| {
        let part = |k: usize| step[0] + (step[1] - step[0]) * k as f64 / parts as f64;
        (0..parts).map(part).collect::<Vec<_>>()
    });
    steps.chain(times.last().copied()).collect()
}
