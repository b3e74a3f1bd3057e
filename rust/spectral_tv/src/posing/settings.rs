//! The parameters of the energy.

use crate::error::{ArgumentError, Result, has_usable_size};

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
    /// Refuses what is not a number, 0 or more.
    ///
    /// # Errors
    /// Names the first that is not.
    pub(super) fn check(&self) -> Result<()> {
        for (name, value) in [
            ("joint_softness", self.joint_softness),
            ("stiffness", self.stiffness),
            ("stillness", self.stillness),
        ] {
            if !(value >= 0.0 && has_usable_size(value)) {
                return Err(ArgumentError::value(
                    name,
                    "must be a number, 0 or more",
                    format_args!("{value:?}"),
                )
                .into());
            }
        }
        Ok(())
    }
}
