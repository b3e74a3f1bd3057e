//! The table of the properties of each method; checks, estimates, messages and front ends read it.

use crate::method::Method;
use crate::named::{Named, quoted};

/// What is known of a method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facts {
    /// What its work is.
    pub work: Work,
    /// Whether it measures from a smooth base.
    pub takes_base: bool,
    /// The finest and the largest scale, relative to the area: from the skin to the largest feature
    /// that the method is for. The flow ends while the body still stands, so that the residual is
    /// one. [`crate::method::Settings::relative_scales`] has those of eigenpairs.
    pub scales: (f64, f64),
}

/// The work of a method, as time and memory count it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Work {
    /// A flow in time steps.
    Flow {
        /// Channels whose systems are solved together.
        solved: usize,
        /// Channels that are held at once, at the peak.
        held: usize,
        /// Time of a step, in steps of a TV flow of as many channels as are solved together.
        cost: f64,
        /// Whether it descends total variation, so that steps can be exact.
        is_total_variation: bool,
    },
    /// Eigenpairs of the Laplace–Beltrami operator.
    Eigenpairs,
    /// The base alone.
    Base,
}

/// The scales of what lies on a base that keeps limbs: folds and plates, and no limbs.
pub(super) const FROM_LIMBS: (f64, f64) = (1e-5, 3e-4);

const fn tv(solved: usize, held: usize, cost: f64) -> Work {
    let is_total_variation = true;
    Work::Flow {
        solved,
        held,
        cost,
        is_total_variation,
    }
}

const fn other(cost: f64) -> Work {
    let is_total_variation = false;
    Work::Flow {
        solved: 3,
        held: 3,
        cost,
        is_total_variation,
    }
}

impl Method {
    /// The row of the method.
    pub const fn facts(self) -> Facts {
        const DETAIL: (f64, f64) = (1e-5, 3e-3);
        const FROM_BASE: (f64, f64) = (1.5e-5, 1e-3);
        let (work, takes_base, scales) = match self {
            Self::ShapeTv => (tv(3, 3, 1.0), false, DETAIL),
            Self::ConformalLaplace => (other(1.2), false, (1.5e-5, 1e-2)),
            Self::DirectionalTv => (tv(1, 1, 1.0), true, FROM_BASE),
            // One by one, and then together.
            Self::Naive => (tv(1, 6, 3.0), false, DETAIL),
            Self::Heat => (other(0.5), false, DETAIL),
            Self::LaplaceBeltrami => (Work::Eigenpairs, false, DETAIL),
            Self::Displacement => (Work::Base, true, FROM_BASE),
        };
        Facts {
            work,
            takes_base,
            scales,
        }
    }
}

impl Facts {
    /// Whether the method takes time steps.
    pub const fn takes_steps(self) -> bool {
        matches!(self.work, Work::Flow { .. })
    }

    /// Whether its steps can be exact.
    pub const fn has_exact_steps(self) -> bool {
        matches!(
            self.work,
            Work::Flow {
                is_total_variation: true,
                ..
            }
        )
    }
}

/// The methods of which something is true, as a message has them.
pub(crate) fn named_where(is_meant: impl Fn(Method) -> bool, link: &str) -> String {
    let methods = Method::NAMES.iter().filter(|(method, _)| is_meant(*method));
    let names: Vec<_> = methods.map(|(_, name)| *name).collect();
    let noun = if names.len() == 1 {
        "method"
    } else {
        "methods"
    };
    format!("the {noun} {}", quoted(&names, link))
}
