//! How long a decomposition takes, by the pace of this machine.

use std::sync::OnceLock;
use std::time::Instant;

use crate::error::Result;
use crate::flow::{TotalVariation, Weights};
use crate::memory::needs::Size;
use crate::mesh::TriangleMesh;
use crate::method::requirements::{check_step_count, is_iterated, step_count};
use crate::method::{Method, Scheme, Settings, graded_times, run_flow};
use crate::monitor::Monitor;
use crate::operators::{Discretization, positions};
use crate::solver::Solver;

/// Vertices along a side of the surface that the pace is taken on, and steps of its flow.
const SIDE: usize = 40;
const STEPS: usize = 6;
/// The power of the size with which a factorization takes longer for each vertex.
const GROWTH: f64 = 0.25;
/// What preparations take, in steps.
const PREPARATION: f64 = 5.0;
/// What the base of M3 takes, in steps.
const BASE: f64 = 7.0;

/// Seconds that decomposing a mesh of so many vertices and triangles takes: a coarse estimate, from
/// how long a small flow took, which the first call measures in some hundredths of a second.
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
    check_step_count(settings)?;
    let size = Size::new(vertices, triangles).count() as f64;
    Ok(pace()? * size * steps_worth(vertices, settings))
}

/// The work at each vertex, in extrapolated steps of M1 by factorization: as it was measured of
/// every method.
fn steps_worth(vertices: usize, settings: &Settings) -> f64 {
    let steps = step_count(settings) as f64;
    let step = match settings.scheme {
        Scheme::SemiImplicit(Weights::Extrapolated) => 1.0,
        Scheme::SemiImplicit(Weights::Lagged) => 0.7,
        Scheme::Exact { .. } => 3.0,
    };
    // Iterations are more work, shared between threads; single functions take more of them.
    let is_iterated = is_iterated(settings, vertices);
    let (step, single) = match is_iterated {
        true => (1.2 * step, 1.5),
        false => {
            let times_larger = vertices as f64 / (SIDE * SIDE) as f64;
            (step * times_larger.max(1.0).powf(GROWTH), 0.75)
        }
    };
    let worth = match &settings.method {
        Method::ShapeTv | Method::ConformalLaplace { .. } => steps * step,
        Method::Heat => 0.7 * steps * step,
        Method::Naive => 3.0 * single * steps * step,
        Method::DirectionalTv { .. } => BASE + single * steps * step,
        Method::LaplaceBeltrami { eigenpairs } => {
            let count = (*eigenpairs).min(vertices) as f64;
            0.6 * count + 5e-4 * count.powi(2)
        }
        Method::Displacement { .. } => BASE,
    };
    PREPARATION + worth
}

/// Seconds that a vertex takes in a step, measured once: the shorter of two flows.
fn pace() -> Result<f64> {
    static PACE: OnceLock<f64> = OnceLock::new();
    if let Some(&pace) = PACE.get() {
        return Ok(pace);
    }
    let pace = measured_pace()?.min(measured_pace()?);
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
    let monitor = Monitor::new();
    let stage = monitor.whole();
    let operators = Discretization::new(&mesh, stage)?;
    let shape = positions(&mesh);
    let law = TotalVariation::starting_at(&operators, shape.view())?;
    let scheme = Scheme::SemiImplicit(Weights::Extrapolated);
    let start = Instant::now();
    run_flow(
        &operators,
        &law,
        scheme,
        shape,
        &times,
        Solver::Cholesky,
        stage,
    )?;
    let taken = start.elapsed().as_secs_f64();
    Ok(taken / (mesh.vertex_count() as f64 * (STEPS as f64 + PREPARATION)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::Steps;

    #[test]
    fn more_vertices_and_steps_take_longer_at_one_pace() {
        let settings = |steps: usize| Settings {
            method: Method::ShapeTv,
            times: None,
            steps: Steps::Count(steps),
            scheme: Scheme::SemiImplicit(Weights::Extrapolated),
            solver: Solver::Cholesky,
        };
        let duration = |vertices: usize, steps: usize| {
            decomposition_duration(vertices, 2 * vertices, &settings(steps)).unwrap()
        };
        assert!(duration(1000, 8) > 0.0);
        let growth = duration(4000, 8) / duration(1000, 8);
        assert!(4.0 < growth && growth < 8.0);
        assert!((duration(1000, 35) / duration(1000, 15) - 2.0).abs() < 1e-12);
    }
}
