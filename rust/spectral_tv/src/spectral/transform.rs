//! φ(t) = t u_tt for arbitrary time nodes, and filtered reconstruction.

use ndarray::{Array2, Axis};

use crate::error::{Error, Result};
use crate::flow::Trajectory;
use crate::spectral::check_edges;

/// The spectral components of a flow (Brokman et al. 2024, Eqs. 50 and 53).
///
/// With velocities p_k = (u_k − u_{k+1})/(t_{k+1} − t_k), the components are
/// φ_k = t_k (p_{k−1} − p_k) for k = 1 … N − 1 and the residual is R = u_N + t_N p_{N−1}. Then
/// f = Σ φ_k + R identically, whatever the nodes and however coarse the steps.
#[derive(Debug, Clone)]
pub struct SpectralTransform {
    trajectory: Trajectory,
}

impl SpectralTransform {
    /// The transform of a flow.
    pub fn new(trajectory: Trajectory) -> Self {
        Self { trajectory }
    }

    /// The flow the transform was made of.
    pub fn trajectory(&self) -> &Trajectory {
        &self.trajectory
    }

    /// t₀ = 0 < t₁ < … < t_N.
    pub fn times(&self) -> &[f64] {
        &self.trajectory.times
    }

    /// t₁ … t_{N−1}, the times of the components.
    pub fn component_times(&self) -> &[f64] {
        let times = self.times();
        &times[1..times.len() - 1]
    }

    /// φ_k for k = `index` + 1, (C, V).
    pub fn component(&self, index: usize) -> Array2<f64> {
        let mut gains = vec![0.0; self.component_times().len()];
        gains[index] = 1.0;
        self.combination(&gains)
    }

    /// R, (C, V).
    pub fn residual(&self) -> Array2<f64> {
        let times = self.times();
        let last = times.len() - 1;
        // R = u_N + t_N/(t_N − t_{N−1}) (u_{N−1} − u_N)
        let reach = times[last] / (times[last] - times[last - 1]);
        let states = &self.trajectory.states;
        let end = states.index_axis(Axis(0), last);
        let before = states.index_axis(Axis(0), last - 1);
        &end + &((&before - &end) * reach)
    }

    /// Σ_k H(t_k) φ_k, (C, V), without the residual; `gains` are the N − 1 values H(t_k).
    ///
    /// # Panics
    /// If there are not N − 1 gains; [`Self::filter`] refuses instead.
    pub fn combination(&self, gains: &[f64]) -> Array2<f64> {
        let times = self.times();
        assert_eq!(gains.len(), self.component_times().len());
        // Σ_k H_k t_k (p_{k−1} − p_k), gathered by velocity: each is read once, and those of
        // steps on which H t is constant not at all.
        let weight = |k: usize| match k {
            0 => 0.0,
            k if k > gains.len() => 0.0,
            k => gains[k - 1] * times[k],
        };
        let (_, channels, vertices) = self.trajectory.states.dim();
        let mut sum = Array2::zeros((channels, vertices));
        for k in 0..times.len() - 1 {
            let factor = (weight(k + 1) - weight(k)) / (times[k + 1] - times[k]);
            if factor != 0.0 {
                sum.scaled_add(factor, &self.trajectory.states.index_axis(Axis(0), k));
                sum.scaled_add(-factor, &self.trajectory.states.index_axis(Axis(0), k + 1));
            }
        }
        sum
    }

    /// The sum of φ_k over edge_i ≤ t_k < edge_{i+1}, (C, V) for each pair of neighbouring
    /// `edges`.
    ///
    /// # Errors
    /// If the edges do not increase.
    pub fn bands(&self, edges: &[f64]) -> Result<Vec<Array2<f64>>> {
        check_edges(edges)?;
        let times = self.component_times();
        let bands = edges.windows(2).map(|edge| {
            let inside = |t: &f64| f64::from(u8::from((edge[0]..edge[1]).contains(t)));
            self.combination(&times.iter().map(inside).collect::<Vec<_>>())
        });
        Ok(bands.collect())
    }

    /// f^H = Σ_k H(t_k) φ_k + R, (C, V) (Brokman et al. 2024, Eq. 53).
    ///
    /// # Errors
    /// If `gains` are not N − 1 finite values.
    pub fn filter(&self, gains: &[f64]) -> Result<Array2<f64>> {
        let expected = self.component_times().len();
        if gains.len() != expected {
            return Err(Error::Argument(format!(
                "gains must have one value per component ({expected}), but has {}",
                gains.len()
            )));
        }
        if let Some(k) = gains.iter().position(|gain| !gain.is_finite()) {
            let gain = gains[k];
            return Err(Error::Argument(format!("gains[{k}] is not finite: {gain}")));
        }
        Ok(self.combination(gains) + self.residual())
    }

    /// S(t_k) = Σ_v M_v |φ_k(v)| for k = 1 … N − 1, |·| over all channels; `masses` are the V
    /// vertex areas.
    pub fn spectrum(&self, masses: &[f64]) -> Vec<f64> {
        (0..self.component_times().len())
            .map(|index| {
                let component = self.component(index);
                component
                    .columns()
                    .into_iter()
                    .zip(masses)
                    .map(|(values, mass)| mass * values.dot(&values).sqrt())
                    .sum()
            })
            .collect()
    }
}
