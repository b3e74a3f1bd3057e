//! The best step along a direction of descent.

/// The search looks no further than this many times the direction.
const LONGEST: f64 = 2.0;
/// Fall of the slope along the line at which the search is done, and its most evaluations.
const SLOPE_TOLERANCE: f64 = 1e-2;
const MOST_EVALUATIONS: usize = 20;

/// The α in [0, 2] that minimises a convex function, given its `slope` and the slope at 0,
/// `start`: the root of the slope, by regula falsi (Illinois); 0 where nothing descends.
pub fn least_along(start: f64, slope: impl Fn(f64) -> f64) -> f64 {
    if start >= 0.0 {
        return 0.0;
    }
    let (mut low, mut low_value) = (0.0, start);
    let (mut high, mut high_value) = (1.0, slope(1.0));
    if high_value < 0.0 {
        (low, low_value) = (high, high_value);
        (high, high_value) = (LONGEST, slope(LONGEST));
        if high_value <= 0.0 {
            return LONGEST;
        }
    }
    let mut alpha = 1.0;
    for _ in 0..MOST_EVALUATIONS {
        let value = match alpha {
            _ if alpha == low => low_value,
            _ if alpha == high => high_value,
            _ => slope(alpha),
        };
        if value.abs() <= SLOPE_TOLERANCE * start.abs() {
            break;
        }
        if value > 0.0 {
            (high, high_value) = (alpha, value);
            low_value *= 0.5;
        } else {
            (low, low_value) = (alpha, value);
            high_value *= 0.5;
        }
        alpha = low - low_value * (high - low) / (high_value - low_value);
    }
    alpha
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_nearly_vanishes_at_the_least_value() {
        let slope = |alpha: f64| alpha.powi(3) - 0.3;
        assert!(slope(least_along(-0.3, slope)).abs() <= 1e-2 * 0.3);
        assert_eq!(least_along(-9.0, |alpha| alpha - 9.0), 2.0);
        assert_eq!(least_along(0.0, |_| 0.0), 0.0);
    }
}
