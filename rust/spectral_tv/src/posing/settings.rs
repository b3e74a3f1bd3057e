//! The parameters of the energy.

use crate::error::{ArgumentError, Result};

/// The largest parameter: larger ones make no difference but to rounding.
const MOST: f64 = 1e6;

/// How a pose is found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// s: how wide and soft joints are; 0 folds them as sharply as the mesh allows.
    pub joint_softness: f64,
    /// ℓ/D: what turning costs, as a length relative to the diagonal of the bounding box.
    pub stiffness: f64,
    /// ρ: what moving away from rest costs.
    pub stillness: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            joint_softness: 1.0,
            stiffness: 0.03,
            stillness: 0.5,
        }
    }
}

impl Settings {
    /// Refuses what is not a number from 0 to 1e6.
    ///
    /// # Errors
    /// Names the first that is not.
    pub(super) fn check(&self) -> Result<()> {
        for (name, value) in [
            ("joint_softness", self.joint_softness),
            ("stiffness", self.stiffness),
            ("stillness", self.stillness),
        ] {
            if !(0.0..=MOST).contains(&value) {
                return Err(ArgumentError::value(
                    name,
                    "must be a number from 0 to 1e6",
                    format_args!("{value:?}"),
                )
                .into());
            }
        }
        Ok(())
    }
}
