//! The order of the operations that join a surface.

use crate::mesh::weld::surface::Surface;
use crate::mesh::weld::{coincident, junctions, near};

/// How often edges are split at most. Two or three times do, but edges that many others cross may
/// take more; whether it ends by itself wherever they are has not been proved.
const MOST_ROUNDS: usize = 1000;

impl Surface {
    /// Makes corners at exactly the same place one.
    pub fn join_coincident(&mut self) {
        coincident::join(self);
    }

    /// Joins what is within `tolerance`, which is above 0.
    pub fn join_within(&mut self, tolerance: f64) {
        for _ in 0..MOST_ROUNDS {
            while near::join(self, tolerance) {}
            if !junctions::close(self, tolerance) {
                break;
            }
        }
    }
}
