//! One band-pass exaggeration for many poses (Brokman et al. 2024, Sec. 7.5 and appendix A).

use std::borrow::Borrow;

use ndarray::Array2;

use crate::error::{ArgumentError, Result, has_usable_size};
use crate::memory::needs;
use crate::mesh::TriangleMesh;
use crate::method::requirements::decomposition_memory_of;
use crate::method::{Settings, decompose_with};
use crate::monitor::{Monitor, Stage};
use crate::operators::positions;

/// The filter: H = 0 below `smooth`, `gain` from `from` to `to`, 1 elsewhere. Times are relative to
/// the area of each shape, so that the filter means the same on every pose and size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exaggeration {
    /// What is finer is removed; 0 keeps all.
    pub smooth: f64,
    /// Start of the band, t/area.
    pub from: f64,
    /// End of the band, t/area.
    pub to: f64,
    /// What the band is multiplied by.
    pub gain: f64,
    /// How much of limbs stays, see [`crate::method::Decomposition::bands_keeping_limbs`].
    pub keep_limbs: f64,
}

impl Exaggeration {
    /// H at a time, for a shape of this area.
    pub fn at(&self, time: f64, area: f64) -> f64 {
        if self.from * area <= time && time < self.to * area {
            self.gain
        } else if time < self.smooth * area {
            0.0
        } else {
            1.0
        }
    }

    /// Between which times H is constant, for a shape of this area that was flowed through `times`; it is 1
    /// beyond the last.
    fn edges(&self, area: f64, times: &[f64]) -> Vec<f64> {
        let end = times[times.len() - 1];
        let mut edges = [0.0, self.smooth, self.from, self.to].map(|edge| (edge * area).min(end));
        edges.sort_by(f64::total_cmp);
        let mut edges = edges.to_vec();
        edges.dedup();
        edges
    }

    fn check(&self) -> Result<()> {
        if !(0.0 <= self.from && self.from < self.to && has_usable_size(self.to)) {
            return Err(ArgumentError::value(
                "band",
                "must be two increasing numbers from 0 to 1e100",
                format_args!("{:?} and {:?}", self.from, self.to),
            )
            .into());
        }
        if !(self.smooth >= 0.0 && has_usable_size(self.smooth)) {
            return Err(ArgumentError::value(
                "smooth",
                "must be 0 or more and at most 1e100",
                format_args!("{:?}", self.smooth),
            )
            .into());
        }
        match has_usable_size(self.gain) {
            true => Ok(()),
            false => Err(ArgumentError::value(
                "gain",
                "must be finite and at most 1e100 in size",
                format_args!("{:?}", self.gain),
            )
            .into()),
        }
    }
}

/// The shapes (3, V) of `meshes`, each decomposed by itself and filtered alike.
///
/// ```
/// use spectral_tv::method::{Exaggeration, Settings, caricature};
///
/// # use spectral_tv::mesh::TriangleMesh;
/// # let vertices = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0.3, 0.3, 1.]];
/// # let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// # let mesh = TriangleMesh::new(vertices, &triangles)?;
/// let filter = Exaggeration { smooth: 5e-5, from: 1e-4, to: 1e-3, gain: 2.0, keep_limbs: 1.0 };
/// let shapes = caricature(&[mesh], &Settings::m3(), &filter)?;
/// assert_eq!(shapes[0].dim(), (3, 4));
/// # Ok::<(), spectral_tv::Error>(())
/// ```
///
/// # Errors
/// If the filter makes no sense, or as [`crate::method::decompose`].
pub fn caricature(
    meshes: &[impl Borrow<TriangleMesh>],
    settings: &Settings,
    filter: &Exaggeration,
) -> Result<Vec<Array2<f64>>> {
    caricature_with(meshes, settings, filter, Monitor::new().whole())
}

/// [`caricature`], watched: `stage` tells how far it is, and cancels it.
///
/// # Errors
/// As [`caricature`], or [`crate::Error::Cancelled`].
pub fn caricature_with(
    meshes: &[impl Borrow<TriangleMesh>],
    settings: &Settings,
    filter: &Exaggeration,
    stage: Stage,
) -> Result<Vec<Array2<f64>>> {
    let meshes: Vec<&TriangleMesh> = meshes.iter().map(Borrow::borrow).collect();
    filter.check()?;
    settings.check()?;
    let most = meshes
        .iter()
        .map(|mesh| decomposition_memory_of(mesh, settings));
    let shapes = meshes.iter().map(|mesh| mesh.vertex_count() as u64).sum();
    stage.require(
        most.max()
            .unwrap_or(0)
            .saturating_add(needs::functions(3, shapes)),
        &format!("exaggerating shapes of {shapes} vertices"),
        "take fewer steps or shapes, or meshes of fewer vertices",
    )?;
    let treat = |(index, mesh): (usize, &&TriangleMesh)| {
        let stage = stage.part(index, meshes.len());
        let split = decompose_with(mesh, settings, stage)?;
        let edges = filter.edges(mesh.area(), split.times());
        let mut shape = positions(mesh);
        if edges.len() < 2 {
            return Ok(shape);
        }
        let bands = split.bands_keeping_limbs_with(&edges, filter.keep_limbs, stage)?;
        for (start, band) in edges.iter().zip(bands) {
            shape.scaled_add(filter.at(*start, mesh.area()) - 1.0, &band);
        }
        Ok(shape)
    };
    meshes.iter().enumerate().map(treat).collect()
}
