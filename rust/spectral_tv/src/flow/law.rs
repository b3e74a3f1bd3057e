//! What drives a flow: u_t = −M(u)⁻¹ L(w(u)) u.

use ndarray::ArrayView2;

use crate::flow::time_step::TimeStep;
use crate::operators::Discretization;

/// The law of a diffusion whose face weights depend on the size of the gradient alone.
pub trait Law {
    /// The weight w of every face from |∇u|² there, in the metric g₀.
    fn weights(&self, squared_gradients: &[f64]) -> Vec<f64>;

    /// The vertex masses at the state `values` (C, V), where they are not those of g₀.
    fn masses(&self, _values: ArrayView2<f64>) -> Option<Vec<f64>> {
        None
    }

    /// Whether an implicit step is a proximal step of TV, so that it can be taken exactly.
    fn is_total_variation(&self) -> bool {
        false
    }

    /// Duality gap of `state` (C, V) as a solution of the step's minimisation, given the weights
    /// it was computed with. 0 for laws whose steps minimise nothing or are linear.
    fn gap(
        &self,
        _operators: &Discretization,
        _step: &TimeStep,
        _state: ArrayView2<f64>,
        _weights: &[f64],
    ) -> f64 {
        0.0
    }
}
