//! How the value of a set decays under the flow, against a straight line.

use ndarray::ArrayView1;

use crate::flow::Trajectory;

/// The value below which the set counts as extinct.
const EXTINCT: f64 = 0.02;
/// The value down to which the function has to keep its two values: later little is left of it.
const ALIVE: f64 = 0.3;

/// The decay of a function that is 1 on a set at first.
#[derive(Debug, Clone)]
pub(super) struct Decay {
    /// The median on the set at every time, N + 1: where the boundary crosses triangles, values are
    /// in between, and a mean would count them.
    pub values: Vec<f64>,
    /// How fast it falls until extinction, per unit of time.
    pub rate: f64,
    /// R² of the straight line through the values until extinction.
    pub straightness: f64,
    /// Largest distance of the function from one with a value per region, relative to it.
    pub spread: f64,
}

impl Decay {
    /// Of a flow of one channel; `regions` (V) numbers the parts on which it ought to stay
    /// constant, 0 being the set.
    pub fn of(trajectory: &Trajectory, regions: &[usize], masses: &[f64]) -> Self {
        let fits: Vec<Fit> = trajectory
            .states()
            .map(|state| Fit::new(state.row(0), regions, masses))
            .collect();
        let values: Vec<f64> = fits.iter().map(|fit| fit.value).collect();
        let extinct = values.iter().position(|&value| value <= EXTINCT);
        let alive = extinct.unwrap_or(values.len()).max(3).min(values.len());
        let (slope, straightness) = line(&trajectory.times[..alive], &values[..alive]);
        let spread = fits[1..]
            .iter()
            .filter(|fit| fit.value > ALIVE)
            .map(|fit| fit.distance)
            .fold(0.0, f64::max);
        Self {
            values,
            rate: -slope,
            straightness,
            spread,
        }
    }
}

/// A state as a function that is constant on every region.
struct Fit {
    /// The median on region 0.
    value: f64,
    /// How far away the nearest one is, relative to its norm.
    distance: f64,
}

impl Fit {
    fn new(state: ArrayView1<f64>, regions: &[usize], masses: &[f64]) -> Self {
        let count = regions.iter().max().map_or(1, |last| last + 1);
        let (mut sums, mut areas) = (vec![0.0; count], vec![0.0; count]);
        for ((value, &region), mass) in state.iter().zip(regions).zip(masses) {
            sums[region] += mass * value;
            areas[region] += mass;
        }
        let mean = |region: usize| sums[region] / areas[region].max(f64::MIN_POSITIVE);
        let mut on_set: Vec<(f64, f64)> = state
            .iter()
            .zip(masses)
            .zip(regions)
            .filter(|(_, region)| **region == 0)
            .map(|((&value, &mass), _)| (value, mass))
            .collect();
        let (mut apart, mut norm) = (0.0, 0.0);
        for ((value, &region), mass) in state.iter().zip(regions).zip(masses) {
            apart += mass * (value - mean(region)).powi(2);
            norm += mass * mean(region).powi(2);
        }
        Self {
            value: median(&mut on_set),
            distance: (apart / norm.max(f64::MIN_POSITIVE)).sqrt(),
        }
    }
}

/// The least value that half of the mass does not exceed; `values` with their masses.
fn median(values: &mut [(f64, f64)]) -> f64 {
    values.sort_unstable_by(|(a, _), (b, _)| a.total_cmp(b));
    let half = 0.5 * values.iter().map(|(_, mass)| mass).sum::<f64>();
    let mut below = 0.0;
    let found = values.iter().find(|(_, mass)| {
        below += mass;
        below >= half
    });
    found.map_or(0.0, |(value, _)| *value)
}

/// Slope of the line of least squares through points, and its R².
fn line(x: &[f64], y: &[f64]) -> (f64, f64) {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (x_mean, y_mean) = (mean(x), mean(y));
    let product = |p: &[f64], p_mean: f64, q: &[f64], q_mean: f64| -> f64 {
        p.iter()
            .zip(q)
            .map(|(p, q)| (p - p_mean) * (q - q_mean))
            .sum()
    };
    let (xx, xy, yy) = (
        product(x, x_mean, x, x_mean),
        product(x, x_mean, y, y_mean),
        product(y, y_mean, y, y_mean),
    );
    match yy > 0.0 {
        true => (xy / xx, xy * xy / (xx * yy)),
        false => (0.0, 0.0), // what stays as it is does not decay
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_counts_masses() {
        assert_eq!(median(&mut [(3.0, 1.0), (1.0, 1.0), (2.0, 5.0)]), 2.0);
        assert_eq!(median(&mut [(3.0, 9.0), (1.0, 1.0), (2.0, 5.0)]), 3.0);
    }

    #[test]
    fn a_line_is_found_and_two_rates_are_not_one() {
        let x = [0.0, 1.0, 2.0, 4.0];
        let (slope, straightness) = line(&x, &x.map(|x| 3.0 - 0.5 * x));
        assert!((slope + 0.5).abs() < 1e-14 && (straightness - 1.0).abs() < 1e-14);
        let (_, straightness) = line(&x, &[1.0, 0.2, 0.15, 0.1]);
        assert!(straightness < 0.8);
        assert_eq!(line(&x, &[1.0; 4]), (0.0, 0.0));
    }
}
