//! Corrections of a step by the matrix that predicted it.

use std::borrow::Cow;

use ndarray::{Array2, Zip};

use crate::error::Result;
use crate::flow::line::Line;
use crate::flow::step_system::StepSystem;
use crate::flow::time_step::TimeStep;
use crate::minimization::{FARTHEST, least_up_to};
use crate::operators::{SideBySide, inner_product, squared_norm};

/// Error of a correction that an iterative solver leaves, relative to the correction: that of the step is
/// some twentieth of it. Ten times as much left the errors of M1's and M2's bands as they were to 0.1 %, on a scan
/// of 134 000 vertices and on a bumpy sphere of 41 000; but three times as much parted bands of collapsing shapes
/// by more than that from those by factorization.
const TOLERANCE: f64 = 1e-3;
/// Most corrections of a step.
const MOST: usize = 2;

/// How a law's steps are corrected.
struct Manner {
    /// Size of a correction, relative to the step's increment and both in the energy norm, beyond which
    /// another follows. Most are 0.5 to 5 %.
    large: f64,
    /// The farthest step along a direction, as a multiple of it.
    farthest: f64,
}

/// Where masses stay.
const USUAL: Manner = Manner {
    large: 0.06,
    farthest: FARTHEST,
};
/// Where masses move, each correction renews them, so that a second gains more. Where a whole shape collapses,
/// the matrix has masses of many times those of the next state, and its directions are as many times too
/// short. Yet longer steps would enlarge what iterative solvers leave.
const WITH_MASSES: Manner = Manner {
    large: 0.02,
    farthest: 4.0,
};

/// Takes descent steps on the energy of the time step from `state`, preconditioned by the matrix at hand,
/// each with the best step length. `size` is the squared norm of what the step has changed so far.
///
/// The masses are `masses`, or where the law moves them those of the state that is corrected.
pub(super) fn correct(
    system: &mut StepSystem,
    step: &TimeStep,
    masses: &[f64],
    size: f64,
    state: &mut Array2<f64>,
) -> Result<()> {
    let Manner { large, farthest } = match system.law.moves_masses() {
        true => WITH_MASSES,
        false => USUAL,
    };
    for _ in 0..MOST {
        let masses = match system.law.masses(state.view()) {
            Some(renewed) => Cow::Owned(renewed),
            None => Cow::Borrowed(masses),
        };
        let square = descend(system, step, &masses, farthest, state)?;
        if square <= large * large * size {
            break;
        }
    }
    Ok(())
}

/// One descent step, at most `farthest` times its direction; returns the squared norm of the step.
fn descend(
    system: &mut StepSystem,
    step: &TimeStep,
    masses: &[f64],
    farthest: f64,
    state: &mut Array2<f64>,
) -> Result<f64> {
    let (stage, law, gradient) = (system.stage, system.law, system.operators.gradient());
    let lanes = stage.pass(|| SideBySide::from(state.view()))?;
    let norms = stage.pass(|| gradient.norms(&lanes))?;
    // Made again: systems take the most memory while they are set up and solved.
    drop(lanes);
    let force = system.force((&norms).into(), state.view())?;
    let descent = stage.pass(|| force.residual(step, masses, state.view()))?;
    let direction = system.increment(&descent, (step, masses), state.view(), None, TOLERANCE)?;
    let square = stage.pass(|| inner_product(descent.view(), direction.view()))?;
    drop(descent);
    let lanes = stage.pass(|| state.view().into())?;
    let direction_lanes = stage.pass(|| direction.view().into())?;
    let line = stage.pass(|| Line::new(law, gradient, norms, &lanes, &direction_lanes))?;
    drop((lanes, direction_lanes));
    let quadratic = stage.pass(|| squared_norm(direction.view(), masses))?;
    let linear = -stage.pass(|| step.pull(masses, state.view(), direction.view()))?;
    let slope = |alpha: f64| linear + alpha * quadratic + step.tau * line.slope(alpha);
    let length = stage.pass(|| least_up_to(farthest, -square, slope))?;
    let advance = |value: &mut f64, direction: &f64| *value += length * direction;
    stage.pass(|| Zip::from(state).and(&direction).par_for_each(advance))?;
    Ok(length * length * square)
}
