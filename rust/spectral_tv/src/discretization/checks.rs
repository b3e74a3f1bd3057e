//! What functions can be worked with on a mesh.

use ndarray::ArrayView2;

use crate::discretization::Discretization;
use crate::error::{ArgumentError, Error, Result, unusable_values};

/// Gradients from here on are refused: their squares, added up, have to be numbers.
const STEEPEST: f64 = 1e145;

impl Discretization {
    /// Refuses functions of values up to `largest` whose gradients could not be squared.
    ///
    /// # Errors
    /// [`Error::Argument`].
    pub fn check_gradients(&self, largest: f64) -> Result<()> {
        match largest * self.steepest_hat < STEEPEST {
            true => Ok(()),
            false => Err(ArgumentError::contradiction(
                "values",
                &["mesh"],
                format!(
                    "values of {largest:.0e} on faces {:.0e} high have gradients beyond {STEEPEST:.0e}",
                    self.steepest_hat.recip()
                ),
            ).into()),
        }
    }

    /// Refuses `values` that are not a finite function on this mesh, (C, V) with C ≥ 1.
    ///
    /// # Errors
    /// Names the shape, or the first vertex and channel whose value is not finite; as
    /// [`Self::check_gradients`].
    pub fn check_values(&self, values: ArrayView2<f64>) -> Result<()> {
        let (channels, vertices) = values.dim();
        if channels == 0 || vertices != self.vertex_count() {
            return Err(ArgumentError::contradiction(
                "values",
                &["mesh"],
                format!(
                    "values must have one row per vertex ({}) and at least one channel, but have \
                     {vertices} rows and {channels} channels",
                    self.vertex_count()
                ),
            )
            .into());
        }
        match unusable_values(values) {
            Some((vertices, channel, value)) => Err(Error::NonFiniteValues {
                vertices,
                channel,
                value,
            }),
            None => {
                let largest = values.iter().fold(0.0_f64, |max, x| max.max(x.abs()));
                self.check_gradients(largest)
            }
        }
    }
}
