//! Deformations, at once and by dragging.

use arbitrary::{Arbitrary, Result, Unstructured};
use ndarray::Array2;
use spectral_tv::Named;
use spectral_tv::deformation::{Algorithm, Constraints, Deformation, Deformer, Settings, deform};
use spectral_tv::mesh::TriangleMesh;
use spectral_tv::operators::positions;

use crate::number::{number, numbers, point, tolerance};
use crate::{assert_finite, largest, unless_refused};

/// Some vertices, pulled anywhere.
#[derive(Debug, Arbitrary)]
struct Pulls {
    #[arbitrary(with = targets)]
    targets: Vec<(u8, [f64; 3])>,
    #[arbitrary(with = numbers)]
    weights: Vec<f64>,
}

fn targets(input: &mut Unstructured) -> Result<Vec<(u8, [f64; 3])>> {
    let count = input.int_in_range(0..=6)?;
    let mut one = || Ok((input.arbitrary()?, point(input)?));
    (0..count).map(|_| one()).collect()
}

impl Pulls {
    /// Indices mostly in range.
    fn indices(&self, mesh: &TriangleMesh) -> Vec<i64> {
        let count = mesh.vertex_count() as i64;
        let index = |index: u8| match index {
            255 => count,
            index => i64::from(index) % count,
        };
        self.targets.iter().map(|(v, _)| index(*v)).collect()
    }

    fn weights(&self) -> Vec<f64> {
        let given = self.weights.iter().copied();
        given
            .chain(std::iter::repeat(1.0))
            .take(self.targets.len())
            .collect()
    }

    fn constraints(&self, mesh: &TriangleMesh) -> Option<Constraints> {
        let weights = self.weights();
        unless_refused(Constraints::new(mesh, &self.indices(mesh), Some(&weights)))
    }

    /// The displacements asked for, times `share`.
    fn positions(&self, mesh: &TriangleMesh, share: f64) -> Vec<[f64; 3]> {
        let pulled = self.indices(mesh).into_iter().zip(&self.targets);
        let place = |(index, (_, target)): (i64, &(u8, [f64; 3]))| {
            let start = mesh.vertices()[index as usize];
            std::array::from_fn(|axis| start[axis] + share * (target[axis] - start[axis]))
        };
        pulled.map(place).collect()
    }

    fn check(&self, mesh: &TriangleMesh, targets: &[[f64; 3]], bent: &Deformation) {
        assert_finite("displacement", &bent.displacement);
        assert_finite("TV and gap", [&bent.total_variation, &bent.gap]);
        assert!(bent.total_variation >= 0.0 && (0.0..=1.0).contains(&bent.gap));
        let start = positions(mesh);
        let shape: Array2<f64> = &start + &bent.displacement;
        let weights = self.weights();
        let size = largest(&start).max(largest(targets.iter().flatten()));
        for ((index, target), weight) in self.indices(mesh).iter().zip(targets).zip(weights) {
            if weight == 1.0 {
                let place = shape.column(*index as usize);
                let error = (0..3).map(|axis| (place[axis] - target[axis]).abs());
                let error = error.fold(0.0, f64::max);
                assert!(error <= 1e-8 * size, "a target is missed by {error:e}");
            }
        }
    }
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
        let Some(constraints) = self.pulls.constraints(mesh) else {
            return;
        };
        let targets = self.pulls.positions(mesh, 1.0);
        let outcome = deform(mesh, constraints, &targets, self.settings);
        if let Some(bent) = unless_refused(outcome) {
            self.pulls.check(mesh, &targets, &bent);
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
        let Some(constraints) = self.pulls.constraints(mesh) else {
            return;
        };
        let deformer = Deformer::new(mesh, constraints, self.softness);
        let Some(mut deformer) = unless_refused(deformer) else {
            return;
        };
        for &share in &self.shares {
            let targets = self.pulls.positions(mesh, share);
            if let Some(bent) = unless_refused(deformer.drag(&targets)) {
                self.pulls.check(mesh, &targets, &bent);
            }
        }
        let sequence = [0.5, 1.0, 0.0].map(|share| self.pulls.positions(mesh, share));
        let outcome = deformer.solve_sequence(&sequence, 1e-2);
        for (targets, bent) in sequence
            .iter()
            .zip(unless_refused(outcome).unwrap_or_default())
        {
            self.pulls.check(mesh, targets, &bent);
        }
    }
}
