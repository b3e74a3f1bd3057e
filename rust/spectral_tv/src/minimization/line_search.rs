//! The best step along a direction of descent.

/// The farthest step, as a multiple of the direction, unless the caller knows better.
pub const FARTHEST: f64 = 2.0;
/// Fall of the slope along the line at which the search is done, and its most evaluations.
const SLOPE_TOLERANCE: f64 = 1e-2;
const MOST_EVALUATIONS: usize = 20;

/// The α in [0, [`FARTHEST`]] that minimises a convex function, given its `slope` and the slope at 0,
/// `start`; see [`least_up_to`].
pub fn least_along(start: f64, slope: impl Fn(f64) -> f64) -> f64 {
    least_up_to(FARTHEST, start, slope)
}

/// The α in [0, `farthest`] that minimises a convex function, given its `slope` and the slope at 0,
/// `start`: the root of the slope, by secants from α = 1 on, and by regula falsi (Illinois) once it
/// lies between two of them; 0 where nothing descends.
pub fn least_up_to(farthest: f64, start: f64, slope: impl Fn(f64) -> f64) -> f64 {
    if start >= 0.0 {
        return 0.0;
    }
    let (mut before, mut low, mut high) = ((0.0, start), (0.0, start), None);
    let mut was_high = None;
    let mut alpha = 1.0;
    for _ in 0..MOST_EVALUATIONS {
        let value = slope(alpha);
        let is_end = alpha == farthest && value < 0.0;
        if is_end || value.abs() <= SLOPE_TOLERANCE * start.abs() {
            break;
        }
        let is_high = value > 0.0;
        let is_stuck = was_high.replace(is_high) == Some(is_high);
        if is_high {
            high = Some((alpha, value));
            low.1 *= if is_stuck { 0.5 } else { 1.0 };
        } else {
            (before, low) = (low, (alpha, value));
            if let Some(high) = high.as_mut().filter(|_| is_stuck) {
                high.1 *= 0.5;
            }
        }
        alpha = match high {
            Some(high) => root_between(low, high),
            None if low.1 > before.1 => root_between(before, low).min(farthest),
            None => farthest,
        };
    }
    alpha
}

/// Where the line through two points (place, value) is 0.
fn root_between((a, at_a): (f64, f64), (b, at_b): (f64, f64)) -> f64 {
    b - at_b * (b - a) / (at_b - at_a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_nearly_vanishes_at_the_least_value() {
        let slope = |alpha: f64| alpha.powi(3) - 0.3;
        assert!(slope(least_along(-0.3, slope)).abs() <= 1e-2 * 0.3);
        for root in [0.3, 0.999, 1.02, 1.9] {
            for slope in [
                |alpha: f64, root: f64| alpha - root,
                |alpha: f64, root: f64| alpha.exp() - root.exp(),
                |alpha: f64, root: f64| (alpha - root).signum() * (alpha - root).abs().sqrt(),
                |alpha: f64, root: f64| (alpha - root).powi(3),
            ] {
                let found = least_along(slope(0.0, root), |alpha| slope(alpha, root));
                assert!(slope(found, root).abs() <= 1e-2 * slope(0.0, root).abs());
            }
        }
        assert_eq!(least_along(-9.0, |alpha| alpha - 9.0), 2.0);
        assert_eq!(least_along(-9.0, |_| -9.0), 2.0);
        // Rounding may have a flat slope fall.
        assert_eq!(least_along(-9.0, |alpha| -9.0 - 1e-12 * alpha), 2.0);
        assert_eq!(least_along(0.0, |_| 0.0), 0.0);
        let far = least_up_to(64.0, -9.0, |alpha| alpha - 9.0);
        assert!((far - 9.0).abs() <= 0.09);
    }
}
