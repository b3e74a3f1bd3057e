//! The result of a deformation.

use ndarray::Array2;

use crate::deformation::constraints::Targets;

/// A displacement that meets constraints.
#[derive(Debug, Clone)]
pub struct Deformation {
    /// d = S′ − S, (3, V), length.
    pub displacement: Array2<f64>,
    /// TV(d), length², pieces without any constraint left out.
    pub total_variation: f64,
    /// A certificate: how far the energy can be above the least, relative to itself.
    pub gap: f64,
    /// Iterations: systems solved for the convex algorithm and the paper's.
    pub iterations: usize,
}

/// Where all constraints ask for one displacement, everything follows it.
pub(super) fn carried(targets: &Targets) -> Deformation {
    let dimensions = targets.displacements.dim();
    let displacement = Array2::from_shape_fn(dimensions, |(axis, _)| targets.centre[axis]);
    Deformation {
        displacement,
        total_variation: 0.0,
        gap: 0.0,
        iterations: 0,
    }
}
