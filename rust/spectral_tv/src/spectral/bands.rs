//! Where the time axis is cut into bands.

use crate::error::{Error, Result};

/// Ratio of the largest scale to the finest that bands are spread over.
const RANGE: f64 = 1e3;

/// `count` + 1 edges that cut (0, t_N] into bands: from 0, then about equally spaced in log t
/// over three decades up to t_N. Component k is in the band with edge_i ≤ t_k < edge_{i+1}.
///
/// Every edge lies half-way between two neighbouring times: φ_k gathers what happens between
/// the midpoints around t_k, so nothing is then counted to the wrong side.
///
/// # Errors
/// If `count` is 0 or there are fewer components than bands.
pub fn logarithmic_edges(times: &[f64], count: usize) -> Result<Vec<f64>> {
    let components = times.len() - 2;
    if count == 0 || count > components {
        return Err(Error::Argument(format!(
            "the number of bands must be between 1 and the number of components, {components}, \
             not {count}"
        )));
    }
    let last = times[times.len() - 1];
    let first = times[1].max(last / RANGE);
    let mut edges = vec![0.0];
    let mut taken = 0;
    for band in 1..count {
        let wanted = first * (last / first).powf(band as f64 / count as f64);
        // At least one component for this band, and one for each that is to come.
        let candidates = taken + 1..=components - (count - band);
        let distance = |&k: &usize| (midpoint(times, k) / wanted).ln().abs();
        taken = candidates
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .expect("bands are no more than components");
        edges.push(midpoint(times, taken));
    }
    edges.push(last);
    Ok(edges)
}

/// Half-way between t_k and t_{k+1}.
fn midpoint(times: &[f64], k: usize) -> f64 {
    0.5 * (times[k] + times[k + 1])
}

/// Refuses edges that do not cut the time axis into bands.
///
/// # Errors
/// If there are fewer than two edges, one is NaN, or they do not increase.
pub fn check_edges(edges: &[f64]) -> Result<()> {
    if edges.len() < 2 {
        return Err(Error::Argument(format!(
            "edges needs at least two values, but has {}",
            edges.len()
        )));
    }
    // Infinity is a fair last edge: everything from there on.
    match edges
        .windows(2)
        .position(|pair| pair[0].partial_cmp(&pair[1]) != Some(std::cmp::Ordering::Less))
    {
        Some(k) => Err(Error::Argument(format!(
            "edges must increase, but edges[{}] is {} after {}",
            k + 1,
            edges[k + 1],
            edges[k]
        ))),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_lie_between_times_and_leave_no_band_empty() {
        let times = [0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0];
        for count in 1..=5 {
            let edges = logarithmic_edges(&times, count).unwrap();
            assert_eq!(edges.len(), count + 1);
            for pair in edges.windows(2) {
                let inside = times[1..6]
                    .iter()
                    .filter(|t| (pair[0]..pair[1]).contains(t));
                assert!(inside.count() > 0);
            }
        }
        assert!(logarithmic_edges(&times, 0).is_err());
        assert!(logarithmic_edges(&times, 6).is_err());
    }

    #[test]
    fn edges_that_do_not_increase_are_refused() {
        assert!(check_edges(&[0.0, 1.0, f64::INFINITY]).is_ok());
        for edges in [&[0.0][..], &[0.0, 0.0], &[0.0, f64::NAN], &[f64::NAN, 1.0]] {
            assert!(check_edges(edges).is_err());
        }
    }
}
