//! Thin parts, and how thickness grows from them.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use crate::error::Result;
use crate::monitor::Stage;
use crate::parallel;
use crate::thickness::ball::Balls;
use crate::thickness::incidence::Incidence;
use crate::thickness::scaled::{Scaled, square_distance};

/// How fast thickness grows along the surface at most.
const SLOPE: f64 = 0.3;
/// The cosine between its points of contact from which on a ball limits the thickness. As it goes to
/// −1, at opposite sides, the limit goes to the radius.
const PARTING: f64 = -0.3;
/// The time of the diffusion that smooths ln r, relative to the area.
const SMOOTHING: f64 = 1e-5;
/// Edges count as if they were no shorter.
const SHORTEST: f64 = 1e-9;
/// Passes of the smoothing, at most.
const PASSES: f64 = 60.0;

/// A vertex in a queue, the least key first.
#[derive(PartialEq)]
struct Entry {
    key: f64,
    vertex: u32,
}

impl Eq for Entry {}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        self.key
            .total_cmp(&other.key)
            .then(self.vertex.cmp(&other.vertex))
    }
}

/// Gives vertices that no ball reached the radius of the nearest vertex that one did.
pub(super) fn filled(
    shape: &Scaled,
    incidence: &Incidence,
    radii: &mut [f64],
    stage: Stage,
) -> Result<()> {
    let mut distances: Vec<f64> = radii
        .iter()
        .map(|radius| if *radius > 0.0 { 0.0 } else { f64::INFINITY })
        .collect();
    let has_empty = |vertex: u32| {
        incidence
            .around(shape, vertex)
            .any(|other| radii[other as usize] == 0.0)
    };
    let known = (0..radii.len() as u32).filter(|v| radii[*v as usize] > 0.0 && has_empty(*v));
    let queue = known.map(|vertex| Reverse(Entry { key: 0.0, vertex }));
    let mut queue: BinaryHeap<_> = queue.collect();
    while let Some(Reverse(Entry { key, vertex })) = queue.pop() {
        stage.check()?;
        if key > distances[vertex as usize] {
            continue;
        }
        for other in incidence.around(shape, vertex) {
            let distance = key + edge(shape, vertex, other);
            if distance < distances[other as usize] {
                distances[other as usize] = distance;
                radii[other as usize] = radii[vertex as usize];
                queue.push(Reverse(Entry {
                    key: distance,
                    vertex: other,
                }));
            }
        }
    }
    Ok(())
}

/// Lowers `radii` (V) to those of balls between opposite sides, and to r + 0.3 d at the distance d
/// from a vertex with r.
pub(super) fn limited(
    shape: &Scaled,
    incidence: &Incidence,
    balls: &Balls,
    radii: &mut [f64],
    stage: Stage,
) -> Result<()> {
    for ball in balls.parts.iter().flatten() {
        if ball.cosine < PARTING {
            let limit = ball.radius * (1.0 + PARTING) / (PARTING - ball.cosine);
            // Where surfaces touch or cross, no triangle tells of less.
            let limit = limit.max(0.5 * mean_edge(shape, incidence, ball.vertex));
            let radius = &mut radii[ball.vertex as usize];
            *radius = radius.min(limit);
        }
    }
    let grows = |vertex: u32| {
        let most = |other: u32| radii[vertex as usize] + SLOPE * edge(shape, vertex, other);
        incidence
            .around(shape, vertex)
            .any(|other| radii[other as usize] > most(other))
    };
    let low = (0..radii.len() as u32).filter(|vertex| grows(*vertex));
    let queue = low.map(|vertex| {
        Reverse(Entry {
            key: radii[vertex as usize],
            vertex,
        })
    });
    let mut queue: BinaryHeap<_> = queue.collect();
    while let Some(Reverse(Entry { key, vertex })) = queue.pop() {
        stage.check()?;
        if key > radii[vertex as usize] {
            continue;
        }
        for other in incidence.around(shape, vertex) {
            let limit = key + SLOPE * edge(shape, vertex, other);
            if limit < radii[other as usize] {
                radii[other as usize] = limit;
                queue.push(Reverse(Entry {
                    key: limit,
                    vertex: other,
                }));
            }
        }
    }
    Ok(())
}

/// Smooths ln r a little: each pass goes half the way to the mean of the neighbours, the nearer ones
/// counting more, so that short edges stay flat.
pub(super) fn smoothed(
    shape: &Scaled,
    incidence: &Incidence,
    radii: Vec<f64>,
    stage: Stage,
) -> Result<Vec<f64>> {
    // Neighbours are at h² = 2/(√3 V); a pass diffuses for h²/8.
    let passes = (SMOOTHING * 4.0 * 3.0_f64.sqrt() * radii.len() as f64).clamp(1.0, PASSES);
    let mut logarithms = parallel::map(&radii, |radius| radius.ln());
    for _ in 0..passes.round() as usize {
        stage.check()?;
        logarithms = parallel::values(logarithms.len(), |vertex| {
            let own = logarithms[vertex];
            let (mut sum, mut total) = (0.0, 0.0);
            for other in incidence.around(shape, vertex as u32) {
                let weight = edge(shape, vertex as u32, other).max(SHORTEST).recip();
                if other as usize != vertex {
                    sum += weight * (logarithms[other as usize] - own);
                    total += weight;
                }
            }
            own + if total > 0.0 { 0.5 * sum / total } else { 0.0 }
        });
    }
    Ok(parallel::map(&logarithms, |logarithm| logarithm.exp()))
}

fn mean_edge(shape: &Scaled, incidence: &Incidence, vertex: u32) -> f64 {
    let lengths = incidence
        .around(shape, vertex)
        .filter(|other| *other != vertex);
    let (sum, count) = lengths.fold((0.0, 0.0), |(sum, count), other| {
        (sum + edge(shape, vertex, other), count + 1.0)
    });
    sum / count
}

fn edge(shape: &Scaled, one: u32, other: u32) -> f64 {
    square_distance(shape.points[one as usize], shape.points[other as usize]).sqrt()
}
