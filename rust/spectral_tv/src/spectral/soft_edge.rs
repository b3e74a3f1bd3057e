//! What a flow leaves beyond an edge between bands.

use ndarray::Array2;

use crate::flow::Trajectory;

/// How wide an edge is, in ln t: about a step of the default 32.
const WIDTH: f64 = 0.2;

/// The factors a_k of F = u(0) + Σ_k a_k (u(t_{k+1}) − u(t_k)), what is left of a function beyond an `edge`
/// of its flow.
///
/// Of a sharp edge that would be u − t u_t: φ = t u_tt, integrated from the edge on, plus the residual. A
/// derivative is only as good as the steps around it, and where a flow has kinks it is never good. So it
/// is replaced by the quotient of differences between a = e^{−0.1} and b = e^{0.1} times the edge,
/// F = (b u(a) − a u(b)) / (b − a). This is the mean of u − t u_t over the edge for the weight 1/t². Between
/// the times u is taken as cubic, by the slopes of parabolas through three states. So F depends on the
/// flow, and on its steps only as far as they are in error.
///
/// The flow ends at T = t_N; an edge near it is that from T e^{−0.2} to T. F is u(0) up to t = 0.
pub(super) fn remainder(times: &[f64], edge: f64) -> Vec<f64> {
    let steps = times.len() - 1;
    let mut factors = vec![0.0; steps];
    if edge <= 0.0 {
        return factors;
    }
    let last = times[steps];
    let (from, to) = match edge * (0.5 * WIDTH).exp() {
        to if to < last => (edge * (-0.5 * WIDTH).exp(), to),
        _ => (last * (-WIDTH).exp(), last),
    };
    // a/(b − a), from the quotient of the two, which tiny times cannot spoil.
    let excess = 1.0 / (WIDTH.exp() - 1.0);
    let (start, end) = (state_at(times, from), state_at(times, to));
    for ((factor, start), end) in factors.iter_mut().zip(start).zip(end) {
        // Steps before the edge count in full, exactly.
        *factor = start - excess * (end - start);
    }
    factors
}

/// What `trajectory` holds between two edges, (C, V).
pub(crate) fn band_between(trajectory: &Trajectory, [from, to]: [f64; 2]) -> Array2<f64> {
    let [from, to] = [from, to].map(|edge| remainder(&trajectory.times, edge));
    let factors: Vec<f64> = from.iter().zip(to).map(|(from, to)| from - to).collect();
    trajectory.sum_of_increments(&factors)
}

/// The same of u(t) for a time up to T.
fn state_at(times: &[f64], time: f64) -> Vec<f64> {
    let steps = times.len() - 1;
    let length = |step: usize| times[step + 1] - times[step];
    let step = times[1..steps].partition_point(|&later| later <= time);
    let mut factors = vec![0.0; steps];
    factors[..step].fill(1.0);
    let share = ((time - times[step]) / length(step)).clamp(0.0, 1.0);
    let rest = 1.0 - share;
    factors[step] += share * share * (3.0 - 2.0 * share);
    let mut add_slope = |node: usize, factor: f64| {
        for (of, weight) in slope_at(node, steps, length) {
            factors[of] += factor * weight * (length(step) / length(of));
        }
    };
    add_slope(step, share * rest * rest);
    add_slope(step + 1, -share * share * rest);
    factors
}

/// The weights of the velocities of steps in that at t_k for k = `node`.
fn slope_at(node: usize, steps: usize, length: impl Fn(usize) -> f64) -> Vec<(usize, f64)> {
    if node == 0 || steps == 1 {
        // A flow starts abruptly.
        return vec![(node.min(steps - 1), 1.0)];
    }
    if node == steps {
        let ratio = length(node - 1) / (length(node - 1) + length(node - 2));
        return vec![(node - 1, 1.0 + ratio), (node - 2, -ratio)];
    }
    let share = length(node) / (length(node - 1) + length(node));
    vec![(node - 1, share), (node, 1.0 - share)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// F of a function of time with this value at 0, by its increments.
    fn found(times: &[f64], edge: f64, value: impl Fn(f64) -> f64) -> f64 {
        let increments = times.windows(2).map(|t| value(t[1]) - value(t[0]));
        let terms = remainder(times, edge).into_iter().zip(increments);
        value(0.0)
            + terms
                .map(|(factor, increment)| factor * increment)
                .sum::<f64>()
    }

    #[test]
    fn an_eigenfunction_vanishes_across_the_edge_at_its_extinction() {
        let times: Vec<f64> = (0..40).map(|k| 0.05 * f64::from(k)).collect();
        let decay = |t: f64| (1.0 - t).max(0.0);
        for (edge, expected) in [(0.0, 1.0), (-1.0, 1.0), (0.7, 1.0), (1.4, 0.0), (9.0, 0.0)] {
            assert!(
                (found(&times, edge, decay) - expected).abs() < 1e-13,
                "{edge}"
            );
        }
        // Half of it on either side, about, for the mean by 1/t².
        let middle = found(&times, 1.0, decay);
        assert!((middle - 0.5).abs() < 0.03, "{middle}");
    }

    #[test]
    fn smooth_flows_give_the_same_at_any_steps_but_for_the_third_order() {
        let decay = |t: f64| (-t).exp();
        let graded = |n: u32| -> Vec<f64> {
            let time = |k| 0.01 * (300_f64.powf(f64::from(k) / f64::from(n)) - 1.0);
            (0..=n).map(time).collect()
        };
        for edge in [0.02, 0.3, 1.1, f64::INFINITY] {
            let exact = found(&graded(4096), edge, decay);
            let errors = [16, 64].map(|n| (found(&graded(n), edge, decay) - exact).abs());
            assert!(
                errors[0] < 0.02 && errors[1] < 0.05 * errors[0] + 1e-6,
                "{edge}: {errors:?}"
            );
        }
    }

    #[test]
    fn steps_before_an_edge_count_in_full_and_those_after_it_not_at_all() {
        let times = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
        let factors = remainder(&times, 3.5);
        assert_eq!(factors[..2], [1.0; 2]);
        assert_eq!(factors[5..], [0.0; 2]);
        assert!(remainder(&[0.0, 5e-324], 1.0)[0].is_finite());
        assert!(
            remainder(&[0.0, 1e-310, 3e-310], 2e-310)
                .iter()
                .all(|factor| factor.is_finite())
        );
    }
}
