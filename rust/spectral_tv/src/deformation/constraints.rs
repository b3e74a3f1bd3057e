//! The constraints of a deformation: where some vertices go, exactly or softly.

use nalgebra::Vector3;
use ndarray::Array2;

use crate::deformation::enclosing_ball::enclosing_ball;
use crate::deformation::floating::Floating;
use crate::error::{ArgumentError, Fault, Result, has_usable_size};
use crate::mesh::TriangleMesh;
use crate::operators::invertible_masses;

/// Positions that differ by no more than this, relative to √area, are the same.
const SAME_POSITION: f64 = 1e-9;
/// A patch of this fraction of the area and weight ½ pulls as hard as a cut of length √area
/// holds back.
const PATCH: f64 = 0.01;
/// The least κ: reciprocals of it and products with displacements are numbers still.
const WEAKEST: f64 = 1e-200;

/// Which vertices are constrained, and how firmly. Each solution takes targets of its own.
#[derive(Debug, Clone)]
pub struct Constraints {
    vertices: Vec<usize>,
    /// w/(1 − w) of every entry, infinite for exact ones.
    firmness: Vec<f64>,
    positions: Vec<[f64; 3]>,
    /// What a spring of firmness 1 is at every vertex, times the spread of the displacements.
    spring: Vec<f64>,
    closeness: f64,
    /// Vertices that are not solved for: those with an exact target, and floating ones.
    pub(super) fixed: Vec<bool>,
    pub(crate) floating: Floating,
    is_constrained: Vec<bool>,
}

/// The displacements that the constraints ask for.
#[derive(Debug, Clone)]
pub(crate) struct Targets {
    /// c at constrained vertices, (3, V), or (C, V) in the coordinates of a span.
    pub displacements: Array2<f64>,
    /// κ of the penalty ½ Σ κ |d − c|² of soft constraints, V.
    pub springs: Vec<f64>,
    /// Centre of the smallest ball that holds the displacements that vertices ask for.
    pub centre: [f64; 3],
    /// Its radius.
    pub radius: f64,
}

impl Targets {
    /// How far apart the displacements asked for are, a length: the diameter of that ball.
    pub fn spread(&self) -> f64 {
        2.0 * self.radius
    }
}

impl Constraints {
    /// Constrains `indices`, with one weight each in (0, 1]: 1 is exact, less is a spring. All
    /// are exact if no weights are given. A patch of area a that hangs on a cut of length p
    /// stays behind by (1 − w)/w · p/√area · 0.01 area/a of the movement.
    ///
    /// # Errors
    /// If there are none, an index is out of range, a weight is not in (0, 1], or no vertex is
    /// left to deform.
    pub fn new(mesh: &TriangleMesh, indices: &[i64], weights: Option<&[f64]>) -> Result<Self> {
        let count = mesh.vertex_count();
        let vertices = checked_indices(indices, count)?;
        let firmness = match weights {
            Some(weights) => firmness(weights, indices)?,
            None => vec![f64::INFINITY; vertices.len()],
        };
        let floating = Floating::new(mesh, vertices.iter().copied());
        let mut fixed = floating.is_floating.clone();
        let mut is_constrained = vec![false; count];
        for (&vertex, firmness) in vertices.iter().zip(&firmness) {
            fixed[vertex] |= firmness.is_infinite();
            is_constrained[vertex] = true;
        }
        if fixed.iter().all(|&fixed| fixed) {
            return Err(ArgumentError::empty(
                "indices",
                "every vertex that could move is constrained exactly; nothing is left to deform",
            )
            .into());
        }
        let size = mesh.area().sqrt();
        let areas = invertible_masses(mesh.vertex_areas());
        Ok(Self {
            firmness,
            positions: vertices.iter().map(|&v| mesh.vertices()[v]).collect(),
            vertices,
            spring: areas.iter().map(|area| area / (PATCH * size)).collect(),
            closeness: SAME_POSITION * size,
            fixed,
            floating,
            is_constrained,
        })
    }

    /// Vertices of connected components without any constraint: each such piece moves rigidly
    /// with the surface nearest to it.
    pub fn floating(&self) -> &[bool] {
        &self.floating.is_floating
    }

    /// The constrained vertices, as they were given.
    pub(crate) fn vertices(&self) -> &[usize] {
        &self.vertices
    }

    /// Whether the constraint with this number is exact.
    pub(crate) fn is_exact(&self, entry: usize) -> bool {
        self.firmness[entry].is_infinite()
    }

    /// Whether there is an exact or soft target for `vertex`.
    pub(super) fn is_asked(&self, vertex: usize) -> bool {
        self.is_constrained[vertex]
    }

    /// The displacements that take every constrained vertex to its target.
    ///
    /// # Errors
    /// If the number of targets is another, one is not finite, or two exact targets of a vertex
    /// differ.
    pub(crate) fn targets(&self, positions: &[[f64; 3]]) -> Result<Targets> {
        self.check(positions)?;
        let mut displacements = Array2::zeros((3, self.fixed.len()));
        let mut firmness = vec![0.0; self.fixed.len()];
        for (entry, &vertex) in self.vertices.iter().enumerate() {
            if self.fixed[vertex] && self.firmness[entry].is_finite() {
                continue; // an exact target wins
            }
            let share = if self.fixed[vertex] {
                1.0
            } else {
                firmness[vertex] += self.firmness[entry];
                self.firmness[entry] / firmness[vertex]
            };
            let asked = Vector3::from(positions[entry]) - Vector3::from(self.positions[entry]);
            for axis in 0..3 {
                let value = &mut displacements[[axis, vertex]];
                *value += share * (asked[axis] - *value);
            }
        }
        // A vertex with several soft targets asks for their mean.
        let asking = displacements
            .columns()
            .into_iter()
            .zip(&self.is_constrained);
        let asked: Vec<_> = asking
            .filter(|(_, is_constrained)| **is_constrained)
            .map(|(asked, _)| Vector3::new(asked[0], asked[1], asked[2]))
            .collect();
        let (centre, radius) = enclosing_ball(&asked);
        let radius = if 2.0 * radius > self.closeness {
            radius
        } else {
            0.0
        };
        let scale = |spring: f64| {
            if radius > 0.0 {
                spring / (2.0 * radius)
            } else {
                spring
            }
        };
        let springs = firmness.iter().zip(&self.spring);
        Ok(Targets {
            springs: springs
                .map(|(&firmness, &spring)| match firmness > 0.0 {
                    // However weak, where nothing else holds a vertex it decides.
                    true => (firmness * scale(spring)).max(WEAKEST),
                    false => 0.0,
                })
                .collect(),
            displacements,
            centre: centre.into(),
            radius,
        })
    }

    fn check(&self, positions: &[[f64; 3]]) -> Result<()> {
        if positions.len() != self.vertices.len() {
            return Err(ArgumentError::value(
                "targets",
                format!(
                    "must be one target per constrained vertex ({})",
                    self.vertices.len()
                ),
                positions.len(),
            )
            .called("there")
            .into());
        }
        let mut first = vec![None; self.fixed.len()];
        for (entry, (&vertex, target)) in self.vertices.iter().zip(positions).enumerate() {
            if !target.iter().all(|&x| has_usable_size(x)) {
                return Err(
                    ArgumentError::non_finite(format!("targets[{entry}]"), target)
                        .called(format!("the target of vertex {vertex}"))
                        .into(),
                );
            }
            if self.firmness[entry].is_finite() {
                continue;
            }
            let other: &[f64; 3] = first[vertex].get_or_insert(target);
            if (0..3).any(|axis| (other[axis] - target[axis]).abs() > self.closeness) {
                return Err(ArgumentError::contradiction(
                    format!("targets[{entry}]"),
                    &["indices", "weights"],
                    format!("vertex {vertex} has two exact targets, {other:?} and {target:?}"),
                )
                .into());
            }
        }
        Ok(())
    }
}

fn checked_indices(indices: &[i64], vertex_count: usize) -> Result<Vec<usize>> {
    if indices.is_empty() {
        return Err(ArgumentError::empty("indices", "there are no constraints").into());
    }
    let check = |(entry, &index): (usize, &i64)| match usize::try_from(index) {
        Ok(vertex) if vertex < vertex_count => Ok(vertex),
        _ => {
            let last = vertex_count - 1;
            let fault = Fault::OutOfRange { index, last };
            Err(ArgumentError::new(format!("indices[{entry}]"), fault)
                .called("a constraint")
                .into())
        }
    };
    indices.iter().enumerate().map(check).collect()
}

fn firmness(weights: &[f64], indices: &[i64]) -> Result<Vec<f64>> {
    if weights.len() != indices.len() {
        return Err(ArgumentError::value(
            "weights",
            format!(
                "must be one weight per constrained vertex ({})",
                indices.len()
            ),
            weights.len(),
        )
        .called("there")
        .into());
    }
    let check = |(entry, (&weight, vertex)): (usize, (&f64, &i64))| {
        if weight > 0.0 && weight <= 1.0 {
            Ok(weight / (1.0 - weight)) // infinite for 1
        } else {
            let name = format!("weights[{entry}]");
            Err(ArgumentError::value(name, "must be in (0, 1]", weight)
                .called(format!("the weight of vertex {vertex}"))
                .into())
        }
    };
    weights.iter().zip(indices).enumerate().map(check).collect()
}
