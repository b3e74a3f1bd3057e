//! φ(t) = t u_tt for arbitrary time nodes, and filtered reconstruction.

use std::sync::Arc;

use ndarray::{Array2, ArrayView1, ArrayView2};

use crate::error::{ArgumentError, Result, has_usable_size};
use crate::flow::Trajectory;
use crate::monitor::Stage;
use crate::parallel;
use crate::spectral::soft_edge::{band_between, remainder};
use crate::spectral::{ThicknessCut, check_edges};

/// The spectral components of a flow (Brokman et al. 2024, Eqs. 50 and 53).
///
/// With velocities p_k = (u_k − u_{k+1})/(t_{k+1} − t_k), the components are
/// φ_k = t_k (p_{k−1} − p_k) for k = 1 … N − 1. They add up to f − u_N − t_N p_{N−1}, whatever the nodes and
/// however coarse the steps.
///
/// Bands are cut between the times too, by edges that are 0.2 wide in ln t; see `soft_edge`. They depend
/// on the flow, and not on its steps. The residual R is what is left beyond the last edge, at t_N, and the
/// last component ends at it, so that f = Σ φ_k + R identically. A filter multiplies whole components: it
/// and the bands agree but for what lies within the edges.
///
/// The components of a flow that is linear between its times lie at the times, so there a band is the sum
/// of the components in it, and R = u_N + t_N p_{N−1}.
#[derive(Debug, Clone)]
pub struct SpectralTransform {
    /// Shared, as it holds all that a flow keeps in memory.
    trajectory: Arc<Trajectory>,
}

impl SpectralTransform {
    /// The transform of a flow.
    pub fn new(trajectory: Trajectory) -> Self {
        Self {
            trajectory: Arc::new(trajectory),
        }
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
        self.trajectory.combined(&self.last_factors())
    }

    /// The factors of the increments in R − u(0).
    fn last_factors(&self) -> Vec<f64> {
        match self.trajectory.is_piecewise_linear() {
            true => self.intercept_factors(self.times().len() - 2),
            false => remainder(self.times(), f64::INFINITY),
        }
    }

    /// The same of u_k + t_k p_k, which is what components up to t_k leave.
    fn intercept_factors(&self, step: usize) -> Vec<f64> {
        let times = self.times();
        let mut factors = vec![0.0; times.len() - 1];
        factors[..step].fill(1.0);
        factors[step] = -times[step] / (times[step + 1] - times[step]);
        factors
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
        let factor = |k: usize| (weight(k) - weight(k + 1)) / (times[k + 1] - times[k]);
        let mut factors: Vec<f64> = (0..times.len() - 1).map(factor).collect();
        if let Some(&gain) = gains.last() {
            // The last component ends at the residual.
            let before = self.intercept_factors(gains.len());
            let ends = before.iter().zip(self.last_factors());
            for (factor, (before, now)) in factors.iter_mut().zip(ends) {
                *factor += gain * (before - now);
            }
        }
        self.trajectory.sum_of_increments(&factors)
    }

    /// What lies between neighbouring `edges`, (C, V) for each pair. Each is summed up when it is asked
    /// for.
    ///
    /// # Errors
    /// If the edges do not increase.
    pub fn bands(&self, edges: &[f64]) -> Result<impl Iterator<Item = Array2<f64>>> {
        check_edges(edges)?;
        let times = self.component_times();
        Ok(edges.windows(2).map(|edge| {
            if self.trajectory.is_piecewise_linear() {
                let inside = |t: &f64| f64::from(u8::from((edge[0]..edge[1]).contains(t)));
                return self.combination(&times.iter().map(inside).collect::<Vec<_>>());
            }
            band_between(&self.trajectory, [edge[0], edge[1]])
        }))
    }

    /// The bands between `edges`, (C, V) each, where the spectrum of every vertex is cut by the
    /// thickness of the shape there.
    ///
    /// # Errors
    /// If the edges do not increase.
    pub(crate) fn bands_cut<'a>(
        &'a self,
        edges: &'a [f64],
        cut: ThicknessCut,
    ) -> Result<impl Iterator<Item = Array2<f64>> + 'a> {
        check_edges(edges)?;
        Ok(cut.bands(&self.trajectory, edges))
    }

    /// f^H = Σ_k H(t_k) φ_k + R, (C, V) (Brokman et al. 2024, Eq. 53).
    ///
    /// # Errors
    /// If `gains` are not N − 1 finite values.
    pub fn filter(&self, gains: &[f64]) -> Result<Array2<f64>> {
        self.check_gains(gains)?;
        Ok(self.combination(gains) + self.residual())
    }

    fn check_gains(&self, gains: &[f64]) -> Result<()> {
        let expected = self.component_times().len();
        if gains.len() != expected {
            return Err(ArgumentError::count(
                "gains",
                format!("must have one value per component ({expected})"),
                gains.len(),
            )
            .into());
        }
        if let Some(k) = gains.iter().position(|gain| !has_usable_size(*gain)) {
            return Err(ArgumentError::non_finite(format!("gains[{k}]"), gains[k]).into());
        }
        Ok(())
    }

    /// The same where the spectrum of every vertex is cut by the thickness of the shape there: the
    /// bands between midpoints of times are filtered, each by H(t_k), and what is later is kept.
    ///
    /// # Errors
    /// If `gains` are not N − 1 finite values.
    pub(crate) fn filter_cut(&self, gains: &[f64], cut: &ThicknessCut) -> Result<Array2<f64>> {
        self.check_gains(gains)?;
        let times = self.times();
        let mut shape = self.trajectory.initial().to_owned();
        for (k, gain) in gains.iter().enumerate() {
            let (edge, next) = match gains.get(k + 1) {
                Some(next) => (0.5 * (times[k + 1] + times[k + 2]), *next),
                None => (times[k + 2], 1.0),
            };
            if *gain != next {
                shape.scaled_add(gain - next, &cut.before(&self.trajectory, edge));
            }
        }
        Ok(shape)
    }

    /// S(t_k) = Σ_v M_v |φ_k(v)| for k = 1 … N − 1, |·| over all channels; `masses` are the V
    /// vertex areas.
    pub fn spectrum(&self, masses: &[f64]) -> Vec<f64> {
        let count = self.component_times().len();
        (0..count)
            .map(|index| self.strength(index, masses))
            .collect()
    }

    /// [`Self::spectrum`], watched: `stage` tells how far it is, and cancels it.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn spectrum_with(&self, masses: &[f64], stage: Stage) -> Result<Vec<f64>> {
        let count = self.component_times().len();
        let strength = |index: usize| {
            stage.report(index as f64 / count as f64)?;
            Ok(self.strength(index, masses))
        };
        let spectrum = (0..count).map(strength).collect();
        stage.report(1.0)?;
        spectrum
    }

    /// S(t_k) for k = `index` + 1.
    fn strength(&self, index: usize, masses: &[f64]) -> f64 {
        integral(self.component(index).view(), masses)
    }
}

/// Σ_v M_v |φ(v)| for `values` φ (C, V).
fn integral(values: ArrayView2<f64>, masses: &[f64]) -> f64 {
    let channels: Vec<ArrayView1<f64>> = values.rows().into_iter().collect();
    parallel::sum(masses.len(), |vertices| {
        let terms = vertices.map(|vertex| {
            let squares = channels.iter().map(|channel| channel[vertex].powi(2));
            masses[vertex] * squares.sum::<f64>().sqrt()
        });
        terms.sum()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discretization::Discretization;
    use crate::flow::{Heat, Weights, semi_implicit_flow};
    use crate::mesh::TriangleMesh;
    use crate::monitor::Monitor;
    use crate::operators::positions;
    use crate::solver::Solver;

    #[test]
    fn components_add_up_in_either_precision_and_a_spectrum_ends_when_cancelled() {
        let vertices = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0.3, 0.4, 1.]];
        let triangles = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];
        let mesh = TriangleMesh::new(vertices, &triangles).unwrap();
        let monitor = Monitor::new();
        let operators = Discretization::new(&mesh).unwrap();
        let times: Vec<f64> = (0..9).map(|k| 0.01 * f64::from(k * k)).collect();
        for solver in [Solver::Cholesky, Solver::Single, Solver::Multigrid] {
            let (weights, shape) = (Weights::Extrapolated, positions(&mesh));
            let stage = monitor.whole();
            let flow = semi_implicit_flow(
                &operators,
                &Heat,
                weights,
                shape.clone(),
                &times,
                solver,
                stage,
            );
            let transform = SpectralTransform::new(flow.unwrap());
            let whole = transform.filter(&[1.0; 7]).unwrap();
            assert!((&whole - &shape).iter().all(|error| error.abs() < 1e-15));
            let bands = transform.bands(&[0.0, 0.07, 0.23, f64::INFINITY]).unwrap();
            let sum = bands.fold(transform.residual(), |sum, band| sum + band);
            assert!((sum - shape).iter().all(|error| error.abs() < 1e-15));
            let cancelled = Monitor::new();
            cancelled.cancel();
            let outcome = transform.spectrum_with(operators.masses(), cancelled.whole());
            assert!(matches!(outcome, Err(crate::Error::Cancelled)));
        }
    }
}
