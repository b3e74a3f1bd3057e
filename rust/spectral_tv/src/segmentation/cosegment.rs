//! Labels for several decompositions at once.

use std::borrow::Borrow;

use ndarray::{Axis, concatenate};

use crate::error::{ArgumentError, Result};
use crate::memory::needs;
use crate::method::Decomposition;
use crate::monitor::{Monitor, Stage};
use crate::segmentation::earth_mover::{QUANTILES, quantile_functions};
use crate::segmentation::k_means::k_means;

/// A label, 0 to `segments` − 1, for every vertex of every shape, from the spectra |φ(t)| of its
/// vertices: k-means under the earth mover's distance, all shapes together, each with the same
/// weight, its vertices with their areas. Segments are numbered by size, the largest first.
///
/// The shapes need not have vertices or triangles in common. With M2 they are parts at different
/// levels: trunk, upper limbs and head, lower limbs, hands.
///
/// ```
/// use spectral_tv::method::{Settings, decompose};
/// use spectral_tv::segmentation::cosegment;
///
/// # use spectral_tv::mesh::TriangleMesh;
/// # let vertices = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0.3, 0.3, 1.]];
/// # let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// # let mesh = TriangleMesh::new(vertices, &triangles)?;
/// let decomposition = decompose(&mesh, &Settings::m2())?;
/// let labels = cosegment(&[decomposition], 2, 0)?;
/// assert!(labels[0].iter().all(|&label| label < 2));
/// # Ok::<(), spectral_tv::Error>(())
/// ```
///
/// # Errors
/// If there is no shape, one has no components, or `segments` is 0 or more than there are vertices;
/// [`crate::Error::Memory`].
pub fn cosegment(
    decompositions: &[impl Borrow<Decomposition>],
    segments: usize,
    seed: u64,
) -> Result<Vec<Vec<usize>>> {
    cosegment_with(decompositions, segments, seed, Monitor::new().whole())
}

/// [`cosegment`], watched: `stage` tells how far it is, and cancels it.
///
/// # Errors
/// As [`cosegment`], or [`crate::Error::Cancelled`].
pub fn cosegment_with(
    decompositions: &[impl Borrow<Decomposition>],
    segments: usize,
    seed: u64,
    stage: Stage,
) -> Result<Vec<Vec<usize>>> {
    let decompositions: Vec<&Decomposition> = decompositions.iter().map(Borrow::borrow).collect();
    let counts = decompositions.iter().map(|d| d.vertex_areas().len());
    let total: usize = counts.clone().sum();
    if decompositions.is_empty() {
        return Err(ArgumentError::empty("decompositions", "there is nothing to segment").into());
    }
    if segments == 0 || segments > total {
        return Err(ArgumentError::value(
            "segments",
            format!("must be between 1 and the number of vertices, {total}"),
            segments,
        )
        .into());
    }
    if let Some(index) = decompositions
        .iter()
        .position(|d| d.component_times().is_empty())
    {
        return Err(ArgumentError::empty(
            format!("decompositions[{index}]"),
            format!("decomposition {index} has no components; it needs at least two steps"),
        )
        .into());
    }
    let components = decompositions.iter().map(|d| d.component_times().len());
    stage.require(
        needs::segments(total, components.max().unwrap_or(0), QUANTILES),
        &format!("segmenting {total} vertices"),
        "take fewer shapes, or meshes of fewer vertices",
    )?;
    let mut functions = Vec::with_capacity(decompositions.len());
    let mut weights = Vec::with_capacity(total);
    for (index, decomposition) in decompositions.iter().enumerate() {
        stage.report(0.5 * index as f64 / decompositions.len() as f64)?;
        functions.push(quantile_functions(decomposition));
        let area: f64 = decomposition.vertex_areas().iter().sum();
        weights.extend(decomposition.vertex_areas().iter().map(|part| part / area));
    }
    let views: Vec<_> = functions.iter().map(|rows| rows.view()).collect();
    let points = concatenate(Axis(0), &views).expect("all have the same quantiles");
    let labels = k_means(
        points.view(),
        &weights,
        segments,
        seed,
        stage.stage(0.5, 1.0),
    )?;
    stage.report(1.0)?;
    let mut labels = labels.into_iter();
    Ok(counts
        .map(|count| labels.by_ref().take(count).collect())
        .collect())
}
