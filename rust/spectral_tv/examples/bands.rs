//! The bands of a PLY file: `cargo run --release --example bands -- shape.ply 4`.
//!
//! Writes one PLY file for each band beside it, `shape.band1.ply` being the finest: the shape
//! without that band. Reads text files of triangles alone, to stay short.

use std::env;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use spectral_tv::mesh::TriangleMesh;
use spectral_tv::method::{Settings, decompose};
use spectral_tv::ndarray::Array2;
use spectral_tv::spectral::even_edges;

type Outcome<T> = Result<T, Box<dyn Error>>;

/// Positions of vertices, and triangles.
type Shape = (Vec<[f64; 3]>, Vec<[i64; 3]>);

/// The vertices and the triangles in the text of a PLY file.
fn read(text: &str) -> Outcome<Shape> {
    let mut lines = text.lines();
    let (mut vertices, mut faces) = (0, 0);
    for line in lines
        .by_ref()
        .take_while(|line| line.trim() != "end_header")
    {
        match line.split_whitespace().collect::<Vec<_>>()[..] {
            ["format", format, _] if format != "ascii" => {
                return Err(format!("the file is {format}; save it as text").into());
            }
            ["element", "vertex", count] => vertices = count.parse()?,
            ["element", "face", count] => faces = count.parse()?,
            _ => {}
        }
    }
    let mut numbers = |wanted: &str| -> Outcome<Vec<f64>> {
        let line = lines
            .next()
            .ok_or(format!("a line is missing that gives {wanted}"))?;
        Ok(line
            .split_whitespace()
            .map(str::parse)
            .collect::<Result<_, _>>()?)
    };
    let position = |_| match numbers("a vertex")?[..] {
        [x, y, z, ..] => Ok([x, y, z]),
        _ => Err("a vertex has fewer than three coordinates".into()),
    };
    let vertices = (0..vertices).map(position).collect::<Outcome<_>>()?;
    let corners = |_| match numbers("a face")?[..] {
        [3.0, i, j, k] => Ok([i as i64, j as i64, k as i64]),
        _ => Err("a face is no triangle".into()),
    };
    Ok((vertices, (0..faces).map(corners).collect::<Outcome<_>>()?))
}

/// The text of a PLY file of a shape (3, V) with the triangles of `mesh`.
fn text(shape: &Array2<f64>, mesh: &TriangleMesh) -> String {
    let (vertices, triangles) = (shape.ncols(), mesh.triangles().len());
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty double x\nproperty double y\n\
         property double z\nelement face {triangles}\nproperty list uchar int vertex_indices\n\
         end_header\n"
    );
    for point in shape.columns() {
        text += &format!("{} {} {}\n", point[0], point[1], point[2]);
    }
    for [i, j, k] in mesh.triangles().iter() {
        text += &format!("3 {i} {j} {k}\n");
    }
    text
}

/// Writes the shape without each of its bands; returns where.
fn run(path: &Path, bands: usize) -> Outcome<Vec<PathBuf>> {
    let (vertices, triangles) = read(&fs::read_to_string(path)?)?;
    let shape = Array2::from_shape_fn((3, vertices.len()), |(axis, v)| vertices[v][axis]);
    let mesh = TriangleMesh::new(vertices, &triangles)?;
    let decomposition = decompose(&mesh, &Settings::m1())?;
    let edges = even_edges(decomposition.times(), bands)?;
    let mut written = Vec::new();
    for (number, band) in (1..).zip(decomposition.bands(&edges)?) {
        let target = path.with_extension(format!("band{number}.ply"));
        fs::write(&target, text(&(&shape - &band), &mesh))?;
        written.push(target);
    }
    Ok(written)
}

fn main() -> Outcome<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let (path, bands) = match &arguments[..] {
        [path] => (path, 4),
        [path, bands] => (path, bands.parse()?),
        _ => return Err("usage: bands FILE.ply [NUMBER OF BANDS]".into()),
    };
    for target in run(Path::new(path), bands)? {
        println!("{}", target.display());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_band_gets_a_file_of_the_same_triangles() {
        let vertices = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0.3, 0.3, 1.]];
        let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
        let shape = Array2::from_shape_fn((3, 4), |(axis, v)| vertices[v][axis]);
        let mesh = TriangleMesh::new(vertices, &triangles).unwrap();
        let folder = env::temp_dir().join(format!("spectral_tv_bands_{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join("shape.ply");
        fs::write(&path, text(&shape, &mesh)).unwrap();
        let written = run(&path, 3).unwrap();
        assert_eq!(written.len(), 3);
        for target in written {
            let (vertices, found) = read(&fs::read_to_string(target).unwrap()).unwrap();
            assert_eq!((vertices.len(), &found[..]), (4, &triangles[..]));
        }
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn what_cannot_be_read_is_told() {
        let header = "ply\nformat binary_little_endian 1.0\nend_header\n";
        assert!(
            read(header)
                .unwrap_err()
                .to_string()
                .contains("save it as text")
        );
        let header = "ply\nformat ascii 1.0\nelement vertex 1\nend_header\n";
        assert!(read(header).unwrap_err().to_string().contains("a vertex"));
    }
}
