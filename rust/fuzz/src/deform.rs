//! Deformations, at once and by dragging.

use arbitrary::{Arbitrary, Result, Unstructured};
use spectral_tv::Named;
use spectral_tv::deformation::{Algorithm, Constraints, Deformation, Deformer, Settings, deform};
use spectral_tv::mesh::TriangleMesh;

use crate::number::{number, numbers, tolerance};
use crate::pulls::Pulls;
use crate::{assert_finite, unless_refused};

fn constraints(pulls: &Pulls, mesh: &TriangleMesh) -> Option<Constraints> {
    let weights = pulls.weights();
    unless_refused(Constraints::new(mesh, &pulls.indices(mesh), Some(&weights)))
}

fn check(pulls: &Pulls, mesh: &TriangleMesh, targets: &[[f64; 3]], bent: &Deformation) {
    assert_finite("displacement", &bent.displacement);
    assert_finite("TV and gap", [&bent.total_variation, &bent.gap]);
    assert!(bent.total_variation >= 0.0 && (0.0..=1.0).contains(&bent.gap));
    pulls.assert_met(mesh, targets, &bent.displacement, |_| true);
}

/// A deformation by any algorithm.
#[derive(Debug, Arbitrary)]
pub struct Deform {
    pulls: Pulls,
    #[arbitrary(with = settings)]
    settings: Settings,
}

fn settings(input: &mut Unstructured) -> Result<Settings> {
    let algorithm = match input.ratio(1, 4)? {
        true => Algorithm::Convex,
        false => input.choose(Algorithm::NAMES)?.0,
    };
    Ok(Settings {
        algorithm,
        softness: softness(input, algorithm == Algorithm::Convex)?,
        tolerance: tolerance(input)?,
    })
}

fn softness(input: &mut Unstructured, is_convex: bool) -> Result<f64> {
    match is_convex && input.ratio(1, 3)? {
        true => number(input),
        false => Ok(0.0),
    }
}

impl Deform {
    pub fn run(&self, mesh: &TriangleMesh) {
        let Some(constraints) = constraints(&self.pulls, mesh) else {
            return;
        };
        let targets = self.pulls.positions(mesh, 1.0);
        let outcome = deform(mesh, constraints, &targets, self.settings);
        if let Some(bent) = unless_refused(outcome) {
            check(&self.pulls, mesh, &targets, &bent);
        }
    }
}

/// A deformer that is dragged, and then solves.
#[derive(Debug, Arbitrary)]
pub struct Drag {
    pulls: Pulls,
    #[arbitrary(with = |input: &mut Unstructured| softness(input, true))]
    softness: f64,
    #[arbitrary(with = numbers)]
    shares: Vec<f64>,
}

impl Drag {
    pub fn run(&self, mesh: &TriangleMesh) {
        let Some(constraints) = constraints(&self.pulls, mesh) else {
            return;
        };
        let deformer = Deformer::new(mesh, constraints, self.softness);
        let Some(mut deformer) = unless_refused(deformer) else {
            return;
        };
        for &share in &self.shares {
            let targets = self.pulls.positions(mesh, share);
            if let Some(bent) = unless_refused(deformer.drag(&targets)) {
                check(&self.pulls, mesh, &targets, &bent);
            }
        }
        let sequence = [0.5, 1.0, 0.0].map(|share| self.pulls.positions(mesh, share));
        let outcome = deformer.solve_sequence(&sequence, 1e-2);
        for (targets, bent) in sequence
            .iter()
            .zip(unless_refused(outcome).unwrap_or_default())
        {
            check(&self.pulls, mesh, targets, &bent);
        }
    }
}
