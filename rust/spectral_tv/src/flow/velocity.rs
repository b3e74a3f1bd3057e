//! p(u), the velocity −u_t that a law gives a state.

use ndarray::{Array2, ArrayView2, aview1};

use crate::discretization::Discretization;
use crate::error::Result;
use crate::flow::force::Force;
use crate::flow::law::Law;
use crate::monitor::Stage;

/// p(u) = M(u)⁻¹ L(w(u)) u at the state u (C, V) (Brokman et al. 2024, Eq. 49), (C, V).
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn velocity(
    operators: &Discretization,
    law: &dyn Law,
    state: ArrayView2<f64>,
    stage: Stage,
) -> Result<Array2<f64>> {
    let unknowns = operators.unknowns(state);
    let at = unknowns.as_ref().map_or(state, |unknowns| unknowns.view());
    let norms = operators.gradient().norms(&at.into());
    let force = Force::new(operators, law, norms.into(), at, stage)?;
    let velocity = match law.masses(at) {
        Some(masses) => force.flux / aview1(&masses),
        None => force.flux / aview1(operators.masses()),
    };
    Ok(operators.values(velocity, state))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flow::{ConformalLaplace, Heat, Scheme, Solver, Stepping, TotalVariation};
    use crate::mesh::TriangleMesh;
    use crate::monitor::Monitor;
    use crate::operators::positions;

    const ROWS: usize = 21;
    const COLUMNS: usize = 17;

    /// A wavy sheet whose vertices and triangles are in any order, with a vertex in no triangle.
    fn sheet() -> TriangleMesh {
        // 5 and 11 have no factor in common with the numbers of vertices and of triangles.
        let number = |i: usize, j: usize| 5 * (i * COLUMNS + j) % (ROWS * COLUMNS) + 1;
        let mut vertices = vec![[0.5, 0.5, 2.0]; ROWS * COLUMNS + 1];
        let mut triangles = Vec::new();
        for i in 0..ROWS {
            for j in 0..COLUMNS {
                let (x, y) = (i as f64 / 20.0, j as f64 / 20.0);
                vertices[number(i, j)] = [x, y, 0.1 * (9.0 * x).sin() * (7.0 * y).cos()];
                if i + 1 < ROWS && j + 1 < COLUMNS {
                    let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
                    let [a, b, c, d] = corners.map(|(i, j)| number(i, j) as i64);
                    triangles.extend([[a, b, c], [c, d, a]]);
                }
            }
        }
        let count = triangles.len();
        let triangles: Vec<_> = (0..count).map(|t| triangles[11 * t % count]).collect();
        TriangleMesh::new(vertices, &triangles).unwrap()
    }

    fn largest(values: &Array2<f64>) -> f64 {
        values.iter().fold(0.0, |max, value| max.max(value.abs()))
    }

    #[test]
    fn flows_in_another_numbering_are_those_in_the_callers() {
        let (mesh, monitor) = (sheet(), Monitor::new());
        let stage = monitor.whole();
        let plain = Discretization::new_with(&mesh, stage).unwrap();
        let numbered = Discretization::numbered(&mesh, stage).unwrap();
        assert!(numbered.masses() != plain.masses());
        assert_eq!(*numbered.vertex_masses(), *plain.masses());
        let times = [0.0, 1e-4, 3e-4, 1e-3, 2e-3, 4e-3, 8e-3];
        let shape = positions(&mesh);
        let height = shape.select(ndarray::Axis(0), &[2]);
        let law = |operators: &Discretization, values: &Array2<f64>, name: &str| -> Box<dyn Law> {
            let tv = TotalVariation::default();
            match name {
                "heat" => Box::new(Heat),
                "conformal" => Box::new(ConformalLaplace::new(operators, 3).unwrap()),
                _ => Box::new(tv.starting_at(operators, values.view()).unwrap()),
            }
        };
        for (name, values) in [
            ("tv", &shape),
            ("tv", &height),
            ("heat", &shape),
            ("conformal", &shape),
        ] {
            let schemes = [Scheme::Extrapolated, Scheme::Lagged, Scheme::Exact];
            let schemes = schemes.into_iter().take(if name == "tv" { 3 } else { 2 });
            for (scheme, solver) in schemes.flat_map(|scheme| {
                [Solver::Cholesky, Solver::Single, Solver::Multigrid].map(|solver| (scheme, solver))
            }) {
                let stepping = Stepping {
                    scheme,
                    solver,
                    ..Stepping::default()
                };
                let [expected, found] = [&plain, &numbered].map(|operators| {
                    let law = law(operators, values, name);
                    let flow = stepping
                        .run(operators, &*law, values.clone(), &times)
                        .unwrap();
                    let end = flow.states().last().unwrap();
                    let velocity = velocity(operators, &*law, values.view(), stage).unwrap();
                    assert_eq!(flow.initial(), values);
                    let states: Vec<_> = flow.states().collect();
                    assert!(largest(&(&end - values)) > 1e-4);
                    (states, velocity)
                });
                let tolerance = match (scheme, solver) {
                    (Scheme::Exact, _) => 1e-3,
                    (_, Solver::Cholesky) => 1e-7,
                    _ => 1e-4,
                };
                for (expected, found) in expected.0.iter().zip(&found.0) {
                    assert!(
                        largest(&(found - expected)) < tolerance * 0.1,
                        "{name} {stepping:?}"
                    );
                }
                let off = largest(&(found.1 - &expected.1));
                assert!(off < 1e-9 * largest(&expected.1));
            }
        }
    }
}
