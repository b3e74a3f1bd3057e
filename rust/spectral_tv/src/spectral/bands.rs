//! Where the time axis is cut into bands.

use crate::error::{Error, Result};

/// `count` + 1 edges that cut (0, t_N] into bands: from 0, then equally spaced in log t from
/// t₁ to t_N. Component k is in the band whose edges hold edge_i ≤ t_k < edge_{i+1}.
///
/// # Errors
/// If `count` is 0.
pub fn logarithmic_edges(times: &[f64], count: usize) -> Result<Vec<f64>> {
    if count == 0 {
        return Err(Error::Argument(
            "the number of bands must be at least 1".into(),
        ));
    }
    let (first, last) = (times[1], times[times.len() - 1]);
    let mut edges: Vec<f64> = (0..count)
        .map(|band| first * (last / first).powf(band as f64 / count as f64))
        .collect();
    edges[0] = 0.0;
    edges.push(last);
    Ok(edges)
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
