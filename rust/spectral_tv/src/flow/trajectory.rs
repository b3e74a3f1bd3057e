//! The states a flow passes through, and what was measured on the way.

use ndarray::{Array1, Array2, ArrayView2, Axis, Zip, concatenate};

use crate::error::{ArgumentError, Result, has_usable_size, unusable_values};
use crate::flow::increment::{Increment, weighted_sum};
use crate::flow::times::check_times;

/// A flow sampled at N + 1 times.
///
/// It keeps the initial state and the increments, these as precisely as they were solved for:
/// velocities, which the spectral transform is made of, are then as precise however short the
/// steps.
#[derive(Debug, Clone)]
pub struct Trajectory {
    /// t₀ = 0 < t₁ < … < t_N.
    pub times: Vec<f64>,
    /// u(0), (C, V).
    pub(super) initial: Array2<f64>,
    /// u(t_{k+1}) − u(t_k), N.
    pub(super) increments: Vec<Increment>,
    /// TV(u(t_k)) over all channels together, N + 1.
    pub total_variation: Vec<f64>,
    /// Duality gap of each step relative to τ TV at its start, N; 0 for linear steps.
    pub gaps: Vec<f64>,
    /// Whether the flow is linear between its times, as far as it is meant.
    pub(super) is_piecewise_linear: bool,
}

impl Trajectory {
    /// A flow of what another was made of: the state `initial` (C, V), N increments (C, V), and what
    /// was measured.
    ///
    /// # Errors
    /// If shapes do not go together, the times do not increase from 0, or a number is not finite,
    /// or beyond 1e100.
    pub fn restored(
        times: Vec<f64>,
        initial: Array2<f64>,
        increments: Vec<Increment>,
        total_variation: Vec<f64>,
        gaps: Vec<f64>,
    ) -> Result<Self> {
        check_times(&times)?;
        let steps = times.len() - 1;
        let have_counts =
            increments.len() == steps && total_variation.len() == steps + 1 && gaps.len() == steps;
        let dimensions = initial.dim();
        let have_shapes = increments.iter().all(|step| step.dim() == dimensions);
        if !have_counts || !have_shapes || initial.is_empty() {
            let message = "the parts of the flow have numbers or shapes that do not go together";
            return Err(
                ArgumentError::contradiction("increments", &["times", "initial"], message).into(),
            );
        }
        let is_whole = unusable_values(initial.view()).is_none()
            && increments.iter().all(Increment::is_usable)
            && total_variation.iter().all(|value| value.is_finite())
            && gaps.iter().all(|value| has_usable_size(*value));
        match is_whole {
            true => Ok(Self {
                times,
                initial,
                increments,
                total_variation,
                gaps,
                is_piecewise_linear: false,
            }),
            false => Err(ArgumentError::contradiction(
                "increments",
                &["initial"],
                "the flow has numbers that are not finite, or beyond 1e100",
            )
            .into()),
        }
    }

    /// The same flow, known to be linear between its times: its spectrum lies at these times alone.
    pub fn piecewise_linear(self) -> Self {
        Self {
            is_piecewise_linear: true,
            ..self
        }
    }

    /// Whether the flow is linear between its times.
    pub fn is_piecewise_linear(&self) -> bool {
        self.is_piecewise_linear
    }

    /// u(t_{k+1}) − u(t_k), N.
    pub fn increments(&self) -> &[Increment] {
        &self.increments
    }

    /// Number of channels C.
    pub fn channel_count(&self) -> usize {
        self.initial.nrows()
    }

    /// Number of vertices V.
    pub fn vertex_count(&self) -> usize {
        self.initial.ncols()
    }

    /// u(0), (C, V).
    pub fn initial(&self) -> ArrayView2<'_, f64> {
        self.initial.view()
    }

    /// u(t_k) for k = 0 … N, (C, V) each, added up on the way.
    pub fn states(&self) -> impl Iterator<Item = Array2<f64>> + '_ {
        // Apart from the first, which may be far from 0: every sum would take digits.
        let mut change = Array2::zeros(self.initial.dim());
        let later = self.increments.iter().map(move |increment| {
            increment.add_to(1.0, &mut change);
            &self.initial + &change
        });
        std::iter::once(self.initial.clone()).chain(later)
    }

    /// Σ_k a_k (u(t_{k+1}) − u(t_k)), (C, V), for the N `factors` a_k.
    pub fn sum_of_increments(&self, factors: &[f64]) -> Array2<f64> {
        let terms = factors.iter().copied().zip(&self.increments);
        weighted_sum(
            self.initial.dim(),
            terms.filter(|&(factor, _)| factor != 0.0),
        )
    }

    /// u(0) + Σ_k a_k (u(t_{k+1}) − u(t_k)), (C, V), for the N `factors` a_k.
    pub fn combined(&self, factors: &[f64]) -> Array2<f64> {
        let mut sum = self.sum_of_increments(factors);
        let add = |sum: &mut f64, initial: &f64| *sum += initial;
        Zip::from(&mut sum).and(&self.initial).par_for_each(add);
        sum
    }

    /// Mean of u(t_k) over the surface weighted by `weights` (V), (N + 1, C): the value of a set
    /// where the weights indicate it. `masses` are the V vertex areas.
    ///
    /// # Errors
    /// If the weights are not V values of 0 or more, or give no area at all.
    pub fn mean(&self, weights: &[f64], masses: &[f64]) -> Result<Array2<f64>> {
        if weights.len() != masses.len() {
            return Err(ArgumentError::count(
                "weights",
                format!("must have one value per vertex ({})", masses.len()),
                weights.len(),
            )
            .into());
        }
        if let Some(v) = weights.iter().position(|w| !(*w >= 0.0 && w.is_finite())) {
            return Err(ArgumentError::value(
                format!("weights[{v}]"),
                "must be 0 or more and finite",
                weights[v],
            )
            .into());
        }
        // Their unit makes no difference, but to what single numbers can hold.
        let largest = weights.iter().fold(0.0_f64, |max, w| max.max(*w));
        let parts = weights.iter().zip(masses).map(|(w, m)| w / largest * m);
        let parts: Array1<f64> = parts.collect();
        let total = parts.sum();
        if largest == 0.0 || total <= 0.0 {
            return Err(
                ArgumentError::empty("weights", "the weights give no vertex any area").into(),
            );
        }
        let mut means = Array2::zeros((self.times.len(), self.channel_count()));
        for (mut mean, state) in means.rows_mut().into_iter().zip(self.states()) {
            mean.assign(&(state.dot(&parts) / total));
        }
        Ok(means)
    }

    /// Several flows at the same times as one of all their channels.
    ///
    /// # Panics
    /// If there are none, or their times differ.
    pub fn side_by_side(mut flows: Vec<Self>) -> Self {
        if flows.len() == 1 {
            return flows.remove(0);
        }
        let times = flows[0].times.clone();
        assert!(flows.iter().all(|flow| flow.times == times));
        let over = |values: fn(&Self) -> &Vec<f64>, merge: fn(f64, f64) -> f64| -> Vec<f64> {
            (0..values(&flows[0]).len())
                .map(|k| flows.iter().map(|flow| values(flow)[k]).fold(0.0, merge))
                .collect()
        };
        let total_variation = over(|flow| &flow.total_variation, |sum, tv| sum + tv);
        let gaps = over(|flow| &flow.gaps, f64::max);
        let (mut initial, mut remaining) = (Vec::new(), Vec::new());
        for flow in flows {
            initial.push(flow.initial);
            remaining.push(flow.increments.into_iter());
        }
        // Step by step, so that each is freed once it is merged.
        let merged = (1..times.len()).map(|_| {
            let parts: Vec<_> = remaining.iter_mut().filter_map(Iterator::next).collect();
            let values: Vec<_> = parts.iter().map(Increment::values).collect();
            Increment::new(&stacked(&values), parts[0].precision())
        });
        Self {
            increments: merged.collect(),
            initial: stacked(&initial),
            times,
            total_variation,
            gaps,
            is_piecewise_linear: false,
        }
    }
}

fn stacked(parts: &[Array2<f64>]) -> Array2<f64> {
    let views: Vec<_> = parts.iter().map(|part| part.view()).collect();
    concatenate(Axis(0), &views).expect("all are on the same vertices")
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::arr2;

    type Parts = (Vec<f64>, Array2<f64>, Vec<Increment>, Vec<f64>, Vec<f64>);

    fn parts() -> Parts {
        let single = Increment::Single {
            values: arr2(&[[1.0, -0.5]]),
            unit: 4.0,
        };
        let increments = vec![Increment::Double(arr2(&[[0.5, 0.25]])), single];
        let initial = arr2(&[[1.0, 2.0]]);
        (
            vec![0.0, 1.0, 2.0],
            initial,
            increments,
            vec![3.0, 2.0, 1.0],
            vec![0.0; 2],
        )
    }

    fn restored((times, initial, increments, variations, gaps): Parts) -> Result<Trajectory> {
        Trajectory::restored(times, initial, increments, variations, gaps)
    }

    #[test]
    fn a_flow_of_the_parts_of_another_has_its_states() {
        let states: Vec<_> = restored(parts()).unwrap().states().collect();
        let expected = [[1.0, 2.0], [1.5, 2.25], [5.5, 0.25]].map(|state| arr2(&[state]));
        assert_eq!(states, expected);
    }

    #[test]
    fn parts_that_do_not_go_together_are_refused() {
        let spoils: [fn(&mut Parts); 9] = [
            |parts| parts.0[1] = 0.0,
            |parts| parts.0.truncate(1),
            |parts| parts.1 = Array2::zeros((2, 1)),
            |parts| parts.1[[0, 1]] = f64::NAN,
            |parts| parts.2.truncate(1),
            |parts| parts.2[1] = Increment::Double(arr2(&[[f64::INFINITY, 0.0]])),
            |parts| {
                let values = arr2(&[[0.0_f32, 0.0]]);
                parts.2[0] = Increment::Single { values, unit: 0.0 };
            },
            |parts| parts.3.push(0.0),
            |parts| parts.4[0] = f64::NAN,
        ];
        for spoil in spoils {
            let mut parts = parts();
            spoil(&mut parts);
            assert!(matches!(restored(parts), Err(crate::Error::Argument(_))));
        }
    }
}
