//! Where the time axis is cut into bands.

use crate::error::{ArgumentError, Result};

/// `count` + 1 edges from 0 to t_N that cut the components into bands of equal numbers.
///
/// Every inner edge lies half-way between two neighbouring times. φ_k gathers what happens between
/// the midpoints around t_k, so each component lies wholly on one side of an edge.
///
/// # Errors
/// If `count` is 0 or there are fewer components than bands.
pub fn even_edges(times: &[f64], count: usize) -> Result<Vec<f64>> {
    let components = times.len() - 2;
    if count == 0 || count > components {
        return Err(ArgumentError::value(
            "bands",
            format!("must be between 1 and the number of components, {components}"),
            count,
        )
        .called("the number of bands")
        .into());
    }
    let edge = |band: usize| match band {
        0 => 0.0,
        band if band == count => times[times.len() - 1],
        band => {
            let last = (band * components + count / 2) / count;
            0.5 * (times[last] + times[last + 1])
        }
    };
    Ok((0..=count).map(edge).collect())
}

/// Most bands at a time: a million are more than any flow has components.
const MOST_BANDS: usize = 1_000_000;

/// Refuses edges that do not cut the time axis into bands.
///
/// # Errors
/// If there are fewer than two edges or those of over a million bands, one is NaN, or they do not
/// increase.
pub fn check_edges(edges: &[f64]) -> Result<()> {
    if edges.len() > MOST_BANDS + 1 {
        return Err(ArgumentError::value(
            "edges",
            format!("must be those of at most {MOST_BANDS} bands"),
            edges.len() - 1,
        )
        .into());
    }
    if edges.len() < 2 {
        return Err(ArgumentError::count("edges", "needs at least two values", edges.len()).into());
    }
    // Infinity is a fair last edge: everything from there on.
    match edges
        .windows(2)
        .position(|pair| pair[0].partial_cmp(&pair[1]) != Some(std::cmp::Ordering::Less))
    {
        Some(k) => Err(ArgumentError::order("edges", "must increase", edges, k + 1).into()),
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
            let edges = even_edges(&times, count).unwrap();
            assert_eq!(edges.len(), count + 1);
            for pair in edges.windows(2) {
                let inside = times[1..6]
                    .iter()
                    .filter(|t| (pair[0]..pair[1]).contains(t));
                assert!(inside.count() > 0);
            }
        }
        assert!(even_edges(&times, 0).is_err());
        assert!(even_edges(&times, 6).is_err());
    }

    #[test]
    fn edges_that_do_not_increase_are_refused() {
        assert!(check_edges(&[0.0, 1.0, f64::INFINITY]).is_ok());
        for edges in [&[0.0][..], &[0.0, 0.0], &[0.0, f64::NAN], &[f64::NAN, 1.0]] {
            assert!(check_edges(edges).is_err());
        }
    }
}
