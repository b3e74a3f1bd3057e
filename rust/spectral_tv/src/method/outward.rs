//! On which side of its base a shape lies: the sign α of M3.

use ndarray::{Array2, ArrayView2, CowArray};

use crate::discretization::Discretization;
use crate::error::Result;
use crate::monitor::Stage;
use crate::operators::element_stiffness;
use crate::parallel;
use crate::solver::{Demand, Solver};

/// How far along the surface directions are kept coherent, squared and relative to the area.
const COHERENCE: f64 = 0.1;
/// Weight of vertices without displacement, relative to the mean, so that the system is regular.
const LEAST_WEIGHT: f64 = 1e-6;
/// Relative error of s that an iterative solver leaves.
const TOLERANCE: f64 = 1e-5;

/// α = ±1 for every vertex, from its displacement D = S − Ŝ and the normal n of Ŝ, both (3, V).
///
/// The plain sign of ⟨D, n⟩ flips wherever D turns tangential, as it does along a tail that
/// bends; f = α|D| then jumps by 2|D|, which no feature of the shape accounts for. What should
/// be continuous is αD/|D|: α changes between neighbours i and j only where D does,
/// σ_ij = sign⟨D_i, D_j⟩ = −1, as where a height field crosses its base. So α is the sign of the
/// s that minimises, with c the cosine between D and n,
/// Σ_i M_i |D_i| (s_i − c_i)² + ℓ² Σ_ij w_ij |⟨D_i, D_j⟩| (s_i − σ_ij s_j)².
pub(super) fn outward_signs(
    operators: &Discretization,
    displacements: ArrayView2<f64>,
    normals: ArrayView2<f64>,
    solver: Solver,
    stage: Stage,
) -> Result<Vec<f64>> {
    let numbered = |values| match operators.unknowns(values) {
        Some(unknowns) => CowArray::from(unknowns),
        None => CowArray::from(values),
    };
    let displacements = stage.pass(|| numbered(displacements))?;
    let normals = stage.pass(|| numbered(normals))?;
    let (gradient, masses) = (operators.gradient(), operators.masses());
    let columns = || displacements.columns().into_iter();
    let lengths: Vec<f64> = columns().map(|d| d.dot(&d).sqrt()).collect();
    let total: f64 = lengths
        .iter()
        .zip(masses)
        .map(|(length, mass)| length * mass)
        .sum();
    let mean = total / operators.area();
    if mean == 0.0 {
        return Ok(vec![1.0; lengths.len()]);
    }
    // w_ij ⟨D_i, D_j⟩ on a face's edges, opposite to its corners.
    let coupling = |face: usize| -> [f64; 3] {
        let [i, j, k] =
            gradient.triangles()[face].map(|corner| displacements.column(corner as usize));
        let products = [j.dot(&k), k.dot(&i), i.dot(&j)];
        let scale = COHERENCE * operators.area() * gradient.face_areas()[face] / (mean * mean);
        let cotangents = element_stiffness(&gradient.hats(face), scale);
        std::array::from_fn(|edge| (-cotangents[edge]).max(0.0) * products[edge])
    };
    let faces = gradient.triangles().len();
    let face_couplings = stage.pass(|| parallel::values(faces, coupling))?;
    let mut diagonal: Vec<f64> = (0..lengths.len())
        .map(|vertex| masses[vertex] * (lengths[vertex] / mean + LEAST_WEIGHT))
        .collect();
    // Assembly gives rows that sum to 0, which holds where σ = 1 only.
    let edges = gradient.triangles().iter().zip(&face_couplings);
    stage.for_each(edges, |(corners, couplings)| {
        let [a, b, c] = couplings.map(|coupling| 2.0 * (-coupling).max(0.0));
        for (&corner, missing) in corners.iter().zip([b + c, c + a, a + b]) {
            diagonal[corner as usize] += missing;
        }
    })?;
    let pattern = operators.pattern();
    let demand = Demand {
        solutions: 1,
        channels: 1,
    };
    let mut solver = operators.solver(solver, demand, stage)?;
    let mut couplings = pattern.zeros();
    let stiffness = |face: usize| face_couplings[face];
    stage.pass(|| pattern.assemble(gradient, &diagonal, stiffness, &mut couplings))?;
    let (_, _, couplings) = couplings.into_raw_storage();
    solver.set_matrix(&diagonal, couplings, 1.0, stage)?;
    let mut data = Array2::zeros((1, lengths.len()));
    for (vertex, (displacement, normal)) in columns().zip(normals.columns()).enumerate() {
        data[[0, vertex]] = masses[vertex] * displacement.dot(&normal) / mean;
    }
    let smoothed = solver.solve(&data, None, TOLERANCE, stage)?;
    let smoothed = operators.values(smoothed, data.view());
    Ok(smoothed
        .iter()
        .map(|&s| if s < 0.0 { -1.0 } else { 1.0 })
        .collect())
}
