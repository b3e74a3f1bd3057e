//! Where handles pass when they turn far, so that what is between them follows the way they turn.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use nalgebra::{UnitQuaternion, Vector3};
use petgraph::unionfind::UnionFind;

use crate::mesh::TriangleMesh;
use crate::posing::motion::{Motion, Pair, fitted};
use crate::posing::state::{aligned, rotated};

/// A turn that is taken at once, radians.
const AT_ONCE: f64 = PI / 4.0;
/// The turn between places of a farther one, radians.
const BETWEEN: f64 = PI / 12.0;

/// What keeps the turn none that a line or a point leaves open, relative to D², per entry.
const PRIOR: f64 = 1e-9;

/// Entries of handles that move together: those that the mesh connects, and bodies.
#[derive(Debug, Clone)]
pub(super) struct Groups(Vec<Group>);

#[derive(Debug, Clone)]
struct Group {
    entries: Vec<usize>,
    /// Whether only the mean of their places counts.
    is_body: bool,
}

impl Groups {
    /// Those of entries at `vertices`, each with its body if it is of one.
    pub fn new(mesh: &TriangleMesh, vertices: &[usize], bodies: &[Option<u32>]) -> Self {
        let mut is_held = vec![false; mesh.vertex_count()];
        for (&vertex, body) in vertices.iter().zip(bodies) {
            is_held[vertex] |= body.is_none();
        }
        let mut held = UnionFind::<usize>::new(is_held.len());
        for corners in mesh.triangles().iter() {
            let [i, j, k] = corners.map(|corner| corner as usize);
            for (one, other) in [(i, j), (j, k), (k, i)] {
                if is_held[one] && is_held[other] {
                    held.union(one, other);
                }
            }
        }
        let mut groups: BTreeMap<(Option<u32>, usize), Vec<usize>> = BTreeMap::new();
        for (entry, (&vertex, &body)) in vertices.iter().zip(bodies).enumerate() {
            let root = body.map_or_else(|| held.find_mut(vertex), |_| 0);
            groups.entry((body, root)).or_default().push(entry);
        }
        let group = |((body, _), entries): ((Option<u32>, usize), Vec<usize>)| Group {
            entries,
            is_body: body.is_some(),
        };
        Self(groups.into_iter().map(group).collect())
    }

    /// Places of the entries between `from` and `to`: none if no group turns far beyond what all
    /// have in `common`. That is done before the first of them. `diagonal` is that of the mesh.
    pub fn waypoints(
        &self,
        from: &[[f64; 3]],
        to: &[[f64; 3]],
        common: &Motion,
        diagonal: f64,
    ) -> Vec<Vec<[f64; 3]>> {
        let motion = |group: &Group| {
            let pair = |&entry: &usize| (1.0, from[entry].into(), to[entry].into());
            let pairs: Vec<Pair> = group.entries.iter().map(pair).collect();
            let count = pairs.len() as f64;
            if group.is_body {
                let off = |pair: &Pair| pair.2 - common.applied(&pair.1);
                return Motion {
                    translation: pairs.iter().map(off).sum::<Vector3<f64>>() / count,
                    ..Motion::none()
                };
            }
            let prior = PRIOR * diagonal * diagonal * count;
            let own = fitted(&pairs, &Motion::none(), prior, |pair| pair.0);
            common.to(&own)
        };
        let motions: Vec<Motion> = self.0.iter().map(motion).collect();
        let turns = motions.iter().map(|motion| turn(motion).norm());
        let largest = turns.fold(0.0, f64::max);
        let count = match largest > AT_ONCE {
            true => (largest / BETWEEN).ceil() as usize,
            false => 1,
        };
        let place = |share: f64| {
            let mut places = to.to_vec();
            for (group, motion) in self.0.iter().zip(&motions) {
                let part = part_of(motion, share);
                for &entry in &group.entries {
                    let start = common.applied(&from[entry].into());
                    let end = Vector3::from(to[entry]);
                    let bent = end - motion.applied(&start);
                    places[entry] = (part.applied(&start) + share * bent).into();
                }
            }
            places
        };
        (1..count)
            .map(|step| place(step as f64 / count as f64))
            .collect()
    }
}

/// The rotation vector of a motion.
fn turn(motion: &Motion) -> Vector3<f64> {
    let none = Motion::none().rotation;
    UnitQuaternion::new_normalize(aligned(motion.rotation, &none)).scaled_axis()
}

/// A share of a motion, as a screw goes: it turns about a fixed axis, and moves along it.
fn part_of(motion: &Motion, share: f64) -> Motion {
    let turn = turn(motion);
    let angle = turn.norm();
    let Some(axis) = turn.try_normalize(f64::EPSILON) else {
        return Motion {
            translation: share * motion.translation,
            ..Motion::none()
        };
    };
    let along = axis.dot(&motion.translation) * axis;
    let across = motion.translation - along;
    let centre = 0.5 * (across + axis.cross(&across) / (0.5 * angle).tan());
    let rotation = UnitQuaternion::from_scaled_axis(share * turn).into_inner();
    Motion {
        translation: centre - rotated(&rotation, &centre) + share * along,
        rotation,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_about_a_line_keeps_its_distance() {
        let axis = Vector3::new(1.0, 2.0, -2.0) / 3.0;
        let centre = Vector3::new(5.0, -1.0, 2.0);
        for angle in [1e-3, 1.0, 3.1, PI] {
            let rotation = UnitQuaternion::from_scaled_axis(angle * axis).into_inner();
            let whole = Motion {
                translation: centre - rotated(&rotation, &centre) + 0.7 * axis,
                rotation,
            };
            let point = Vector3::new(0.3, 0.1, 4.0);
            assert!((part_of(&whole, 1.0).applied(&point) - whole.applied(&point)).norm() < 1e-9);
            let half = part_of(&whole, 0.5);
            let [before, between] = [point, half.applied(&point)].map(|p| p - centre);
            let distance = |p: Vector3<f64>| axis.cross(&p).norm();
            assert!((distance(before) - distance(between)).abs() < 1e-9);
            assert!((axis.dot(&(between - before)) - 0.35).abs() < 1e-9);
            let again = half.applied(&half.applied(&point));
            assert!((again - whole.applied(&point)).norm() < 1e-9);
        }
    }
}
