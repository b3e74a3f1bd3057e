//! How long a decomposition takes, estimated from the pace of this machine.

use std::sync::OnceLock;
use std::time::Instant;

use crate::discretization::Discretization;
use crate::error::Result;
use crate::flow::{Scheme, Stepping, TotalVariation};
use crate::memory::needs::{Size, Solved};
use crate::mesh::TriangleMesh;
use crate::method::facts::Work;
use crate::method::{Base, Settings, graded_times, limbs};
use crate::operators::positions;
use crate::solver::Solver;

/// Vertices along a side of the surface that the pace is taken on, and steps of its flow.
const SIDE: usize = 40;
const STEPS: usize = 6;
/// What preparations take, in steps.
const PREPARATION: f64 = 4.0;
/// The parts of the work that no thread shares, on large meshes and more on those of this size.
const UNSHARED: f64 = 0.1;
const UNSHARED_SMALL: f64 = 0.3;
const SMALL: f64 = 1e4;

/// Seconds that decomposing a mesh of so many vertices and triangles takes by the threads of the
/// current pool: within a factor of two on an idle machine, from how long a small flow took one of
/// them, which the first call measures in some hundredths of a second.
///
/// Other work on the machine counts as far as it was there then. Where an accuracy decides on the
/// steps, the time is that of the first two flows.
///
/// # Errors
/// If the number of steps makes no sense; or as that flow, which should not fail.
pub fn decomposition_duration(
    vertices: usize,
    triangles: usize,
    settings: &Settings,
) -> Result<f64> {
    settings.check()?;
    let size = Size::new(vertices, triangles).count() as f64;
    Ok(pace()? * size * steps_worth(size, settings) / speedup(size))
}

/// How many times faster all threads are than one (Amdahl's law).
fn speedup(size: f64) -> f64 {
    let unshared = UNSHARED + UNSHARED_SMALL * (SMALL / size).min(1.0);
    1.0 / (unshared + (1.0 - unshared) / rayon::current_num_threads() as f64)
}

/// The work at each vertex of a mesh of this size, in sixths of the small flow: fitted to what
/// every method took on 10 000 to 655 000 vertices.
fn steps_worth(size: f64, settings: &Settings) -> f64 {
    let steps = settings.step_count() as f64;
    let scheme = match settings.stepping.scheme {
        Scheme::Extrapolated => 1.0,
        Scheme::Lagged => 0.47,
        Scheme::Exact => 1.9,
    };
    // Steps of one channel are two of Newton's.
    let newton = match settings.stepping.scheme {
        Scheme::Extrapolated => 1.8,
        _ => 1.0,
    };
    // A step of three channels and of one. Factors fill up as the mesh grows, and iterations miss
    // the caches.
    let (three, one) = match settings.solved(size as usize) {
        Solved::Iteratively => {
            let step = scheme * 0.9 * (size / 4e4).max(0.1).powf(0.19);
            (step, 1.9 * newton * step)
        }
        Solved::Exactly | Solved::InSingle => {
            let step = scheme * 0.68 * (size / (SIDE * SIDE) as f64).max(1.0).powf(0.27);
            (step, 0.8 * newton * step)
        }
    };
    let facts = settings.method.facts();
    let base = match (facts.takes_base, &settings.base) {
        (true, Base::Limbs) => limbs::STEPS as f64 * three,
        (true, _) => 6.5 * (size / 1e4).max(0.1).powf(0.25),
        (false, _) => 0.0,
    };
    let worth = match settings.work() {
        Work::Flow { solved, cost, .. } => steps * cost * if solved == 1 { one } else { three },
        Work::Eigenpairs => {
            let count = (settings.eigenpairs as f64).min(size);
            1.9 * count + 1.6e-3 * count.powi(2)
        }
        Work::Base => 0.0,
    };
    PREPARATION + base + worth
}

/// Seconds that a vertex takes one thread in a step of the small flow, measured once: the shortest
/// of four.
fn pace() -> Result<f64> {
    static PACE: OnceLock<f64> = OnceLock::new();
    if let Some(&pace) = PACE.get() {
        return Ok(pace);
    }
    let shorter = |pace: f64, _| Result::Ok(pace.min(measured_pace()?));
    let measure = || (1..4).try_fold(measured_pace()?, shorter);
    // A small flow would not show what many threads are worth on a large one.
    let pace = match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
        Ok(single) => single.install(measure)?,
        Err(_) => measure()?,
    };
    Ok(*PACE.get_or_init(|| pace))
}

fn measured_pace() -> Result<f64> {
    let place = |index: usize| {
        let (x, y) = ((index % SIDE) as f64, (index / SIDE) as f64);
        [x, y, (0.7 * x).sin() * (0.4 * y).cos()]
    };
    let vertices: Vec<_> = (0..SIDE * SIDE).map(place).collect();
    let corners =
        (0..SIDE - 1).flat_map(|row| (0..SIDE - 1).map(move |column| row * SIDE + column));
    let triangles: Vec<_> = corners
        .flat_map(|a| {
            let [a, b, c, d] = [a, a + 1, a + 1 + SIDE, a + SIDE].map(|corner| corner as i64);
            [[a, b, c], [a, c, d]]
        })
        .collect();
    let mesh = TriangleMesh::new(vertices, &triangles)?;
    let times = graded_times(1e-5 * mesh.area(), 3e-3 * mesh.area(), STEPS)?;
    let operators = Discretization::new(&mesh)?;
    let shape = positions(&mesh);
    let law = TotalVariation::default().starting_at(&operators, shape.view())?;
    let stepping = Stepping {
        solver: Solver::Cholesky,
        ..Stepping::default()
    };
    let start = Instant::now();
    stepping.run(&operators, &law, shape, &times)?;
    let taken = start.elapsed().as_secs_f64();
    Ok(taken / (mesh.vertex_count() as f64 * STEPS as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn duration(vertices: usize, steps: usize) -> f64 {
        let mut settings = Settings {
            steps,
            ..Settings::m1()
        };
        settings.stepping.solver = Solver::Cholesky;
        decomposition_duration(vertices, 2 * vertices, &settings).unwrap()
    }

    #[test]
    fn more_vertices_and_steps_take_longer_at_one_pace() {
        assert!(duration(1000, 8) > 0.0);
        let growth = duration(400_000, 8) / duration(100_000, 8);
        assert!(4.0 < growth && growth < 8.0);
        let [few, more, many] = [10, 20, 30].map(|steps| duration(1000, steps));
        assert!((many - 2.0 * more + few).abs() < 1e-12 * many);
    }

    #[test]
    fn threads_share_most_of_the_work() {
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.unwrap().install(|| duration(1_000_000, 32))
        };
        let faster = with(1) / with(8);
        assert!(2.0 < faster && faster < 8.0);
    }
}
