//! Which side of each triangle is outside.

use std::f64::consts::PI;

use crate::error::Result;
use crate::monitor::Stage;
use crate::thickness::incidence::Incidence;
use crate::thickness::scaled::{Scaled, cross, difference, dot};

/// The volume that a surface encloses, relative to that of a ball of its area, below which it is a
/// sheet.
const SHEET: f64 = 0.02;

/// The outer sides of triangles.
pub(super) struct Outward {
    /// 1 where the winding of a triangle is that seen from outside, −1 where it is that seen from
    /// inside, F.
    pub signs: Vec<i8>,
    /// Whether a triangle is of a sheet, which has no inside, F.
    pub is_sheet: Vec<bool>,
}

impl Outward {
    /// Follows the surface over edges of two triangles, and turns each such patch so that it
    /// encloses a positive volume.
    pub fn new(shape: &Scaled, incidence: &Incidence, stage: Stage) -> Result<Self> {
        let count = shape.triangles.len();
        let mut signs = vec![0_i8; count];
        let mut is_sheet = vec![false; count];
        let mut patch: Vec<u32> = Vec::new();
        for &first in shape.parts.iter().flatten() {
            if signs[first as usize] != 0 {
                continue;
            }
            patch.clear();
            patch.push(first);
            signs[first as usize] = 1;
            let mut next = 0;
            while let Some(&face) = patch.get(next) {
                if next % (1 << 14) == 0 {
                    stage.check()?;
                }
                next += 1;
                for (neighbour, is_alike) in neighbours(shape, incidence, face) {
                    if signs[neighbour as usize] == 0 {
                        let sign = signs[face as usize];
                        signs[neighbour as usize] = if is_alike { sign } else { -sign };
                        patch.push(neighbour);
                    }
                }
            }
            let fullness = fullness(shape, &patch, &signs);
            for &face in &patch {
                is_sheet[face as usize] = fullness.abs() < SHEET;
                if fullness < 0.0 {
                    signs[face as usize] = -signs[face as usize];
                }
            }
        }
        Ok(Self { signs, is_sheet })
    }

    /// The unit normal of a triangle that points outward.
    pub fn normal(&self, shape: &Scaled, face: u32) -> [f64; 3] {
        let normal = shape.area_normal(face);
        let length = dot(normal, normal).sqrt();
        let factor = f64::from(self.signs[face as usize]) / length;
        normal.map(|x| if length > 0.0 { factor * x } else { 0.0 })
    }
}

/// The triangles beyond those edges of one that have two, and whether they are wound alike.
fn neighbours<'a>(
    shape: &'a Scaled,
    incidence: &'a Incidence,
    face: u32,
) -> impl Iterator<Item = (u32, bool)> + 'a {
    let corners = shape.triangles[face as usize];
    (0..3).filter_map(move |k| {
        let (from, to) = (corners[k], corners[(k + 1) % 3]);
        let has_end =
            |other: &&u32| **other != face && shape.triangles[**other as usize].contains(&to);
        let mut others = incidence.faces(from).iter().filter(has_end);
        let (&other, more) = (others.next()?, others.next());
        let triangle = shape.triangles[other as usize];
        let runs_alike = (0..3).any(|k| (triangle[k], triangle[(k + 1) % 3]) == (from, to));
        more.is_none().then_some((other, !runs_alike))
    })
}

/// The volume between a patch and its centroid, relative to that of a ball of its area.
fn fullness(shape: &Scaled, patch: &[u32], signs: &[i8]) -> f64 {
    let area = shape.area_of(patch);
    let mut centroid = [0.0; 3];
    for &face in patch {
        let share = shape.areas[face as usize] / (3.0 * area);
        for corner in shape.corners(face) {
            centroid = std::array::from_fn(|axis| centroid[axis] + share * corner[axis]);
        }
    }
    let volume = |face: &u32| {
        let [p, q, r] = shape
            .corners(*face)
            .map(|corner| difference(corner, centroid));
        f64::from(signs[*face as usize]) * dot(p, cross(q, r)) / 6.0
    };
    patch.iter().map(volume).sum::<f64>() * 6.0 * PI.sqrt() / area.powf(1.5)
}
