//! How thickness changes along the surface.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use crate::error::Result;
use crate::monitor::Stage;
use crate::parallel;
use crate::thickness::incidence::Incidence;
use crate::thickness::scaled::Scaled;

/// How fast thickness grows along the surface at most.
const SLOPE: f64 = 0.3;
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
    let queue = queue.collect();
    spread(
        shape,
        incidence,
        &mut distances,
        queue,
        1.0,
        stage,
        |from, to| {
            radii[to as usize] = radii[from as usize];
        },
    )
}

/// Lowers `radii` (V) to r + 0.3 d at the distance d from a vertex with r.
pub(super) fn limited(
    shape: &Scaled,
    incidence: &Incidence,
    radii: &mut [f64],
    stage: Stage,
) -> Result<()> {
    let grows = |vertex: u32| {
        let most = |other: u32| radii[vertex as usize] + SLOPE * shape.distance(vertex, other);
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
    let queue = queue.collect();
    spread(shape, incidence, radii, queue, SLOPE, stage, |_, _| ())
}

/// Lowers `keys` (V) to at most key + `slope` d at the distance d along edges from those in the queue
/// (Dijkstra's algorithm), and tells of each that is lowered, from which and to which vertex.
fn spread(
    shape: &Scaled,
    incidence: &Incidence,
    keys: &mut [f64],
    mut queue: BinaryHeap<Reverse<Entry>>,
    slope: f64,
    stage: Stage,
    mut lowered: impl FnMut(u32, u32),
) -> Result<()> {
    while let Some(Reverse(Entry { key, vertex })) = queue.pop() {
        stage.check()?;
        if key > keys[vertex as usize] {
            continue;
        }
        for other in incidence.around(shape, vertex) {
            let key = key + slope * shape.distance(vertex, other);
            if key < keys[other as usize] {
                keys[other as usize] = key;
                lowered(vertex, other);
                let vertex = other;
                queue.push(Reverse(Entry { key, vertex }));
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
    // Neighbours are at h² = 2/(√3 V) on the whole; a pass diffuses for h²/8, where they are farther too.
    let passes = (SMOOTHING * 4.0 * 3.0_f64.sqrt() * radii.len() as f64).clamp(1.0, PASSES);
    let spacing = (2.0 / (3.0_f64.sqrt() * radii.len() as f64)).sqrt();
    let mut logarithms = parallel::map(&radii, |radius| radius.ln());
    for _ in 0..passes.round() as usize {
        stage.check()?;
        logarithms = parallel::values(logarithms.len(), |vertex| {
            let own = logarithms[vertex];
            let (mut sum, mut total, mut count) = (0.0, 0.0, 0.0);
            for other in incidence.around(shape, vertex as u32) {
                let weight = shape.distance(vertex as u32, other).max(SHORTEST).recip();
                if other as usize != vertex {
                    sum += weight * (logarithms[other as usize] - own);
                    total += weight;
                    count += 1.0;
                }
            }
            let share = 0.5 * (spacing * total / count).powi(2).min(1.0);
            own + if total > 0.0 {
                share * sum / total
            } else {
                0.0
            }
        });
    }
    Ok(parallel::map(&logarithms, |logarithm| logarithm.exp()))
}
