//! A bar that is bent: `cargo run --release --example deformation`.

use std::error::Error;
use std::f64::consts::TAU;

use spectral_tv::deformation::{Constraints, Settings, deform};
use spectral_tv::mesh::TriangleMesh;
use spectral_tv::ndarray::Array2;

/// A tube of the radius 1 along x, with `rings` rings of `around` vertices.
fn tube(rings: usize, around: usize) -> spectral_tv::Result<TriangleMesh> {
    let point = |k: usize| {
        let angle = TAU * (k % around) as f64 / around as f64;
        [0.5 * (k / around) as f64, angle.cos(), angle.sin()]
    };
    let vertices = (0..rings * around).map(point).collect();
    let cells = (0..rings - 1).flat_map(|i| (0..around).map(move |j| (i, j)));
    let triangles = cells.flat_map(|(i, j)| {
        let index = |i: usize, j: usize| (i * around + j % around) as i64;
        let (a, b) = (index(i, j), index(i, j + 1));
        let (c, d) = (index(i + 1, j + 1), index(i + 1, j));
        [[a, b, c], [a, c, d]]
    });
    TriangleMesh::new(vertices, &triangles.collect::<Vec<_>>())
}

/// The displacement of a tube whose first ring stays and whose last one moves up by `height`.
fn bend(rings: usize, around: usize, height: f64) -> spectral_tv::Result<Array2<f64>> {
    let mesh = tube(rings, around)?;
    let last = (rings - 1) * around;
    let handles: Vec<usize> = (0..around).chain(last..last + around).collect();
    let target = |&vertex: &usize| {
        let [x, y, z] = mesh.vertices()[vertex];
        [x, y, if vertex < last { z } else { z + height }]
    };
    let targets: Vec<[f64; 3]> = handles.iter().map(target).collect();
    let indices: Vec<i64> = handles.iter().map(|&vertex| vertex as i64).collect();
    let constraints = Constraints::new(&mesh, &indices, None)?;
    let settings = Settings {
        softness: 2.0,
        ..Settings::default()
    };
    Ok(deform(&mesh, constraints, &targets, settings)?.displacement)
}

fn main() -> Result<(), Box<dyn Error>> {
    let (rings, around) = (24, 16);
    let displacement = bend(rings, around, 3.0)?;
    for ring in 0..rings {
        println!(
            "ring {ring:2} rises by {:.3}",
            displacement[[2, ring * around]]
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn handles_go_where_they_are_told_and_what_is_between_follows() {
        let displacement = bend(8, 6, 3.0).unwrap();
        let rise = |ring: usize| displacement[[2, 6 * ring]];
        assert!(rise(0).abs() < 1e-9 && (rise(7) - 3.0).abs() < 1e-9);
        assert!((1..8).all(|ring| rise(ring) >= rise(ring - 1) - 1e-3));
    }
}
