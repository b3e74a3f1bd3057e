//! A flow by a law of one's own: `cargo run --release --example law`.
//!
//! The law is between heat flow and total-variation flow: w = 1/√(1 + n²/k²) hardly slows what is
//! flatter than k, and leaves what is steeper to fade at the speed of TV.

use std::error::Error;
use std::f64::consts::TAU;

use spectral_tv::discretization::{Discretization, positions};
use spectral_tv::flow::{Law, Stepping};
use spectral_tv::mesh::TriangleMesh;
use spectral_tv::method::graded_times;
use spectral_tv::spectral::SpectralTransform;

struct Charbonnier {
    /// k, the gradient from which on the law is that of TV.
    steep: f64,
}

impl Law for Charbonnier {
    fn weigh(&self, gradient_norms: &mut [f64]) {
        let weight = |n: f64| 1.0 / (1.0 + (n / self.steep).powi(2)).sqrt();
        gradient_norms.iter_mut().for_each(|n| *n = weight(*n));
    }
}

/// A wavy sheet of `size` × `size` vertices on the unit square.
fn sheet(size: usize) -> spectral_tv::Result<TriangleMesh> {
    let point = |i: usize, j: usize| {
        let (x, y) = (i as f64 / (size - 1) as f64, j as f64 / (size - 1) as f64);
        [x, y, 0.1 * (TAU * x).sin() + 0.02 * (6.0 * TAU * y).sin()]
    };
    let vertices = (0..size * size)
        .map(|k| point(k % size, k / size))
        .collect();
    let cells = (0..size - 1).flat_map(|j| (0..size - 1).map(move |i| (i, j)));
    let triangles = cells.flat_map(|(i, j)| {
        let a = (j * size + i) as i64;
        let (b, c, d) = (a + 1, a + 1 + size as i64, a + size as i64);
        [[a, b, c], [a, c, d]]
    });
    TriangleMesh::new(vertices, &triangles.collect::<Vec<_>>())
}

/// The strength of every component of a sheet, and how far all of them together are from it.
fn run(size: usize, steps: usize) -> spectral_tv::Result<(Vec<f64>, f64)> {
    let mesh = sheet(size)?;
    let operators = Discretization::new(&mesh)?;
    let times = graded_times(1e-4 * mesh.area(), 1e-2 * mesh.area(), steps)?;
    let shape = positions(&mesh);
    let law = Charbonnier { steep: 0.5 };
    let flow = Stepping::default().run(&operators, &law, shape.clone(), &times)?;
    let transform = SpectralTransform::new(flow);
    let same = transform.filter(&vec![1.0; transform.component_times().len()])?;
    let error = (same - shape)
        .iter()
        .fold(0.0_f64, |most, x| most.max(x.abs()));
    Ok((transform.spectrum(mesh.vertex_areas()), error))
}

fn main() -> Result<(), Box<dyn Error>> {
    let (spectrum, error) = run(60, 16)?;
    for (component, strength) in spectrum.iter().enumerate() {
        println!("component {component:2}: {strength:.3e}");
    }
    println!("all of them make the sheet again but for {error:.0e}");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_components_together_are_the_sheet() {
        let (spectrum, error) = run(12, 6).unwrap();
        assert_eq!(spectrum.len(), 5);
        assert!(spectrum.iter().all(|strength| *strength > 0.0));
        assert!(error < 1e-5);
    }
}
