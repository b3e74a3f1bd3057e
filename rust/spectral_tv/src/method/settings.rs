//! What follows from settings, and those of each method by default.

use std::f64::consts::PI;

use crate::error::Result;
use crate::memory::needs::Solved;
use crate::method::adaptive_steps::FEWEST_STEPS;
use crate::method::facts::{FROM_LIMBS, Work};
use crate::method::schedule::graded_times;
use crate::method::{Base, Flowing, Method, Settings};

impl From<Method> for Settings {
    fn from(method: Method) -> Self {
        Self {
            method,
            ..Self::default()
        }
    }
}

impl Settings {
    /// Those of M1, shape spectral TV.
    pub fn m1() -> Self {
        Method::ShapeTv.into()
    }

    /// Those of M2, conformalized 3-Laplace.
    pub fn m2() -> Self {
        Method::ConformalLaplace.into()
    }

    /// Those of M3, directional TV.
    pub fn m3() -> Self {
        Method::DirectionalTv.into()
    }

    /// How far the flow to the base goes, length², for a shape of this area.
    pub fn base_duration(&self, area: f64) -> f64 {
        self.base_time.unwrap_or(self.base.time() * area)
    }

    /// The work of the method with these settings.
    pub(super) fn work(&self) -> Work {
        match (self.method.facts().work, self.displacement) {
            (Work::Flow { .. }, Flowing::Vector) => Method::ShapeTv.facts().work,
            (work, _) => work,
        }
    }

    /// c and t_N relative to the area, as [`graded_times`] takes them.
    pub fn relative_scales(&self) -> (f64, f64) {
        let (finest, largest) = self.method.facts().scales;
        match self.method.facts().work {
            _ if self.base == Base::Limbs => FROM_LIMBS,
            // Weyl's law: the K-th eigenvalue of a surface is near 4πK/area.
            Work::Eigenpairs => {
                let finest = 1.0 / (4.0 * PI * self.eigenpairs as f64);
                (finest, (8.0 * finest).max(largest))
            }
            _ => (finest, largest),
        }
    }

    /// N + 1 times from 0 for N = `steps`, length², by [`graded_times`]. Their ends are fractions of
    /// the surface `area` that depend on the method, so that one filter means the same on every pose
    /// and size.
    ///
    /// # Errors
    /// If `steps` is 0.
    pub fn default_times(&self, area: f64, steps: usize) -> Result<Vec<f64>> {
        let (finest, largest) = self.relative_scales();
        graded_times(area * finest, area * largest, steps)
    }

    /// Steps that are taken and kept; with an accuracy those of the first two flows.
    pub(super) fn step_count(&self) -> usize {
        let given = self
            .times
            .as_ref()
            .map(|times| times.len().saturating_sub(1));
        match self.accuracy {
            None => given.unwrap_or(self.steps),
            // The flow with so many steps, and twice as many.
            Some(_) => given.unwrap_or(0).max(FEWEST_STEPS).saturating_mul(3),
        }
    }

    /// The number of steps; with an accuracy the fewest.
    pub(super) fn fewest_steps(&self) -> usize {
        self.accuracy.map_or(self.steps, |_| FEWEST_STEPS)
    }

    /// How the systems of the method's flow on so many vertices are solved.
    pub(super) fn solved(&self, vertices: usize) -> Solved {
        let channels = match self.work() {
            Work::Flow { solved, .. } => solved,
            _ => 3,
        };
        self.stepping.solved(vertices, channels)
    }
}
