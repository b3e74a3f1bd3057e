//! Points all over a surface.

use rstar::primitives::GeomWithData;

use crate::thickness::scaled::{Scaled, square_distance};

/// Points at which balls are inscribed, over all parts: half of them as the area is, half of them as
/// the triangles are, as fine parts have finer ones.
const SAMPLES: usize = 4000;
/// Points of a part, at least.
const FEWEST: usize = 16;
/// How far the points by which balls know the surface are from one another at most.
const FAR: f64 = 0.01;

/// A point on the surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// Where it is.
    pub point: [f64; 3],
    /// The triangle that it is on.
    pub face: u32,
    /// The corner that is next to it.
    pub vertex: u32,
}

/// Points on one part of the surface. The first of them, as many as is told besides, are spread as
/// the area is.
pub(super) fn samples(shape: &Scaled, part: &[u32]) -> (Vec<Sample>, usize) {
    let area = shape.area_of(part);
    let share = 0.5 * (area + part.len() as f64 / shape.triangles.len() as f64);
    let half = (share * SAMPLES as f64 / 2.0).round() as usize;
    let half = half.max(FEWEST / 2);
    let mut found = Vec::with_capacity(2 * half);
    let (mut faces, mut reached) = (part.iter(), 0.0);
    let mut face = part[0];
    for k in 0..half {
        let place = (k as f64 + 0.5) / half as f64 * area;
        while reached < place {
            let Some(&next) = faces.next() else { break };
            face = next;
            reached += shape.areas[face as usize];
        }
        found.push(sample(shape, face, k));
    }
    let by_number = half.min(part.len());
    for k in 0..by_number {
        let face = part[(2 * k + 1) * part.len() / (2 * by_number)];
        found.push(sample(shape, face, half + k));
    }
    (found, half)
}

/// A point by which balls know the surface, and how far others are from it at most.
pub(super) type Obstacle = GeomWithData<[f64; 3], f64>;

/// The vertices of a part of the surface, and points on its large triangles.
pub(super) fn obstacles(shape: &Scaled, part: &[u32]) -> Vec<Obstacle> {
    let mut corners = Vec::with_capacity(3 * part.len());
    for &face in part {
        let [p, q, r] = shape.corners(face);
        let sides = [
            square_distance(p, q),
            square_distance(q, r),
            square_distance(r, p),
        ];
        let longest = sides.into_iter().fold(0.0, f64::max).sqrt().min(FAR);
        corners.extend(shape.triangles[face as usize].map(|corner| (corner, longest)));
    }
    corners.sort_unstable_by(|a, b| (b.0, b.1).partial_cmp(&(a.0, a.1)).expect("finite"));
    corners.dedup_by_key(|(corner, _)| *corner);
    let vertices = corners.into_iter();
    let mut found: Vec<_> = vertices
        .map(|(vertex, distance)| Obstacle::new(shape.points[vertex as usize], distance))
        .collect();
    for &face in part {
        let count = (shape.areas[face as usize] / (FAR * FAR / 2.0)) as usize;
        found.extend((0..count).map(|k| Obstacle::new(point_on(shape, face, k), FAR)));
    }
    found
}

fn sample(shape: &Scaled, face: u32, k: usize) -> Sample {
    let point = point_on(shape, face, k);
    let distance = |vertex: &u32| square_distance(shape.points[*vertex as usize], point);
    let corners = shape.triangles[face as usize];
    let nearest = corners
        .into_iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)));
    Sample {
        point,
        face,
        vertex: nearest.expect("three corners"),
    }
}

/// The k-th point of an even sequence inside a triangle (Roberts 2018, the R₂ sequence).
fn point_on(shape: &Scaled, face: u32, k: usize) -> [f64; 3] {
    let place = |step: f64| (0.5 + step * (k + 1) as f64).fract();
    let (u, v) = (place(0.754_877_666_246_693), place(0.569_840_290_998_053));
    let (u, v) = if u + v > 1.0 {
        (1.0 - u, 1.0 - v)
    } else {
        (u, v)
    };
    let [p, q, r] = shape.corners(face);
    std::array::from_fn(|axis| p[axis] + u * (q[axis] - p[axis]) + v * (r[axis] - p[axis]))
}
