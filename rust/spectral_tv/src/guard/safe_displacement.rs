//! The part of a displacement that folds and stretches nothing.

use std::ops::Range;

use ndarray::{Array2, ArrayView2};

use crate::error::Result;
use crate::guard::displaced::Displaced;
use crate::guard::ramp::Ramp;
use crate::guard::screen::Screen;
use crate::guard::stretch::check_stretch;
use crate::memory::needs;
use crate::mesh::TriangleMesh;
use crate::monitor::{Monitor, Stage};
use crate::parallel;

/// What of the gain at which a face folds or stretches is kept.
const KEPT: f64 = 0.85;
/// The length over which the share that is kept rises from 0 to 1, relative to the size. Without ramps
/// the next faces fold at the step.
const RAMP: f64 = 0.03;
/// After so many rounds a corner of a face that still folds keeps at most half of what it has, and
/// after twice as many nothing: a face whose corners stay cannot fold.
const PATIENCE: usize = 32;
/// Up to this gain nothing may fold: more than 1, so that rounding takes nothing from that.
const SAFE: f64 = 1.0 + 1e-9;

/// A displacement that is clamped, by which a mesh neither folds nor stretches.
#[derive(Debug, Clone, PartialEq)]
pub struct SafeDisplacement {
    /// The displacement, (3, V).
    pub displacement: Array2<f64>,
    /// The share of the displacement that each vertex keeps, in [0, 1], V.
    pub shares: Vec<f64>,
    /// How long the clamped displacement is, relative to the one asked for; both as means over the
    /// area. 1 if nothing had to be clamped.
    pub kept: f64,
    /// How many times shares were lowered.
    pub rounds: usize,
}

/// As much of a `displacement` (3, V) of `mesh` as neither folds nor stretches a face: its safe gain
/// by [`crate::guard::folds`], with the same `stretch`, is at least 1.
///
/// Each vertex keeps a share of its displacement. Where a face reaches the margin of folding, or an
/// edge the limit, at a gain below 1, its corners keep 0.85 of that gain. From there the share
/// rises along the edges, by 1 over 0.03 of the root of the area. This is repeated until no face folds.
///
/// For what exaggerates a shape, a band at a gain above 0. It is of no use for what smooths one: where
/// the whole of a band is taken away, clamped parts stay as shreds. It does not keep distant
/// parts from meeting: see [`crate::guard::self_intersections`].
///
/// # Errors
/// If the displacement is not of this mesh or not finite, `stretch` is not above 1, or memory does
/// not suffice.
pub fn safe_displacement(
    mesh: &TriangleMesh,
    displacement: ArrayView2<f64>,
    stretch: f64,
) -> Result<SafeDisplacement> {
    safe_displacement_with(mesh, displacement, stretch, Monitor::new().whole())
}

/// [`safe_displacement`], watched: `stage` tells how far it is, and cancels it.
///
/// # Errors
/// As [`safe_displacement`], or [`crate::Error::Cancelled`].
pub fn safe_displacement_with(
    mesh: &TriangleMesh,
    displacement: ArrayView2<f64>,
    stretch: f64,
    stage: Stage,
) -> Result<SafeDisplacement> {
    check_stretch(stretch)?;
    stage.report(0.0)?;
    stage.require(
        needs::safe_displacement(needs::Size::of(mesh)),
        &format!(
            "clamping a displacement of {} vertices",
            mesh.vertex_count()
        ),
        "take a mesh of fewer vertices",
    )?;
    let displaced = Displaced::new(mesh, displacement)?;
    let mut shares = vec![1.0_f64; mesh.vertex_count()];
    let mut shifts = displaced.shifts.to_vec();
    let mut ramp = None;
    let mut rounds = 0;
    loop {
        let look = |part| clamps(&displaced, &shifts, stretch, part);
        let parts = stage.pass(|| parallel::parts(mesh.triangles().len(), look))?;
        let clamps = || parts.iter().flatten().copied();
        if clamps().next().is_none() {
            break;
        }
        let most = match rounds / PATIENCE {
            0 => 1.0,
            1 => 0.5,
            _ => 0.0,
        };
        // Each vertex by the least gain of its faces, of what it has kept so far.
        let before = shares.clone();
        stage.for_each(clamps(), |(vertex, gain)| {
            let vertex = vertex as usize;
            shares[vertex] = shares[vertex].min(before[vertex] * (KEPT * gain).min(most));
        })?;
        let ramp = match &ramp {
            Some(ramp) => ramp,
            None => ramp.insert(Ramp::new(mesh, RAMP * mesh.area().sqrt(), stage)?),
        };
        ramp.lower(&mut shares, clamps().map(|(vertex, _)| vertex), stage)?;
        shifts = stage.pass(|| {
            parallel::values(shares.len(), |vertex| {
                displaced.shifts[vertex].map(|shift| shares[vertex] * shift)
            })
        })?;
        rounds += 1;
        // How many are to come is not known.
        stage.report(1.0 - 0.8_f64.powi(rounds as i32))?;
    }
    let kept = kept(mesh, &displaced.shifts, &shares);
    let displacement = Array2::from_shape_fn((3, shifts.len()), |(axis, v)| shifts[v][axis]);
    stage.report(1.0)?;
    Ok(SafeDisplacement {
        displacement,
        shares,
        kept,
        rounds,
    })
}

/// Corners of those `faces` that fold or stretch below gain 1, and at which gain.
fn clamps(
    displaced: &Displaced,
    shifts: &[[f64; 3]],
    stretch: f64,
    faces: Range<usize>,
) -> Vec<(u32, f64)> {
    let mut clamps = Vec::new();
    let screen = Screen::new(stretch, SAFE, f64::INFINITY);
    displaced.for_each_face(faces, shifts, screen, |index, face, _| {
        if face.safe_gain(stretch, SAFE) < SAFE {
            let corners = displaced.mesh.triangles()[index];
            let gains = corners.into_iter().zip(face.safe_gains(stretch, SAFE));
            clamps.extend(gains.filter(|&(_, gain)| gain < SAFE));
        }
    });
    clamps
}

/// Mean length of the clamped shifts relative to that of the shifts, over the area.
fn kept(mesh: &TriangleMesh, shifts: &[[f64; 3]], shares: &[f64]) -> f64 {
    let largest = shifts.as_flattened().iter();
    let largest = largest.fold(0.0_f64, |most, shift| most.max(shift.abs()));
    if largest == 0.0 {
        return 1.0;
    }
    let (mut before, mut after) = (0.0, 0.0);
    for ((shift, share), area) in shifts.iter().zip(shares).zip(mesh.vertex_areas()) {
        let squares = shift.iter().map(|shift| (shift / largest).powi(2));
        let length = area * squares.sum::<f64>().sqrt();
        before += length;
        after += share * length;
    }
    match before > 0.0 {
        true => after / before,
        // Nothing but vertices in no triangle moves.
        false => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::guard::{DEFAULT_STRETCH, folds};

    /// A flat sheet of `size` by `size` vertices, one apart.
    fn sheet(size: usize) -> TriangleMesh {
        let at = |k: usize, j: usize| (size * k + j) as i64;
        let cells = (1..size).flat_map(|k| (1..size).map(move |j| (k, j)));
        let triangles: Vec<[i64; 3]> = cells
            .flat_map(|(k, j)| {
                let [a, b, c, d] = [at(k - 1, j - 1), at(k, j - 1), at(k, j), at(k - 1, j)];
                [[a, b, c], [a, c, d]]
            })
            .collect();
        let vertices = (0..size * size).map(|v| [(v / size) as f64, (v % size) as f64, 0.0]);
        TriangleMesh::new(vertices.collect(), &triangles).unwrap()
    }

    #[test]
    fn what_is_safe_stays_as_it_is() {
        let mesh = sheet(9);
        let lift = Array2::from_shape_fn((3, 81), |(axis, v)| match axis {
            2 => (v as f64).sin(),
            _ => 0.0,
        });
        let safe = safe_displacement(&mesh, lift.view(), DEFAULT_STRETCH).unwrap();
        assert_eq!((safe.displacement, safe.kept, safe.rounds), (lift, 1.0, 0));
        let none = Array2::zeros((3, 81));
        let safe = safe_displacement(&mesh, none.view(), DEFAULT_STRETCH).unwrap();
        assert_eq!((safe.displacement, safe.kept), (none, 1.0));
    }

    #[test]
    fn a_spike_is_cut_and_the_share_rises_around_it() {
        let mesh = sheet(41);
        let middle = 41 * 20 + 20;
        let spike = Array2::from_shape_fn((3, 41 * 41), |(axis, v)| match (axis, v) {
            (2, v) if v == middle => 20.0,
            (2, _) => 1.0,
            _ => 0.0,
        });
        let safe = safe_displacement(&mesh, spike.view(), DEFAULT_STRETCH).unwrap();
        assert!(
            folds(&mesh, safe.displacement.view(), DEFAULT_STRETCH)
                .unwrap()
                .safe_gain
                >= 1.0
        );
        let least = safe
            .shares
            .iter()
            .fold(1.0, |least: f64, &share| least.min(share));
        assert!(safe.shares[middle] == least && least < 0.2);
        assert!(safe.shares[0] == 1.0 && safe.kept < 1.0);
        // By no more than 1 over 0.03 of the size along an edge.
        let slope = 1.0 / (RAMP * mesh.area().sqrt());
        for (v, share) in safe.shares.iter().enumerate().take(41 * 40) {
            assert!((share - safe.shares[v + 41]).abs() <= slope * (1.0 + 1e-12));
        }
    }

    #[test]
    fn the_wildest_displacement_becomes_safe() {
        let mesh = sheet(12);
        let mut random = fastrand::Rng::with_seed(3);
        for size in [1.0, 30.0, 1e6, 1e99] {
            let wild = Array2::from_shape_fn((3, 144), |_| size * (random.f64() - 0.5));
            for stretch in [1.0 + 1e-9, 1.1, DEFAULT_STRETCH, 1e6] {
                let safe = safe_displacement(&mesh, wild.view(), stretch).unwrap();
                let found = folds(&mesh, safe.displacement.view(), stretch).unwrap();
                assert!(found.safe_gain >= 1.0, "{found:?}");
                assert!(found.flipped.is_empty() && found.stretched.is_empty());
                assert!((0.0..=1.0).contains(&safe.kept));
            }
        }
    }
}
