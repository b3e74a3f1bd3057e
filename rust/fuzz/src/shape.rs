//! Meshes of up to some tens of vertices, most of them bad.

use arbitrary::{Arbitrary, Result, Unstructured};
use spectral_tv::mesh::{Broken, Repair, TriangleMesh};

use crate::number::{number, point};
use crate::{assert_finite, unless_refused};

/// Vertices and triangles as a file may hold them.
#[derive(Debug)]
pub struct Shape {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[i64; 3]>,
    repair: Repair,
}

impl<'a> Arbitrary<'a> for Shape {
    fn arbitrary(input: &mut Unstructured<'a>) -> Result<Self> {
        let mut shape = match input.int_in_range(0..=2)? {
            0 => grid(input)?,
            1 => bipyramid(input)?,
            _ => soup(input)?,
        };
        for _ in 0..input.int_in_range(0..=3)? {
            shape.hurt(input)?;
        }
        let scale = match input.int_in_range(0..=7)? {
            7 => 10_f64.powi(input.int_in_range(-90..=60)?),
            5 | 6 => 10_f64.powi(input.int_in_range(-9..=7)?),
            _ => 1.0,
        };
        let away = match input.int_in_range(0..=7)? {
            7 => point(input)?,
            _ => [0.0; 3],
        };
        for vertex in &mut shape.vertices {
            *vertex = std::array::from_fn(|axis| scale * (vertex[axis] + away[axis]));
        }
        shape.repair = Repair {
            weld: match input.int_in_range(0..=7)? {
                7 => Some(number(input)?),
                6 => Some(scale * 10_f64.powi(input.int_in_range(-9..=2)?)),
                5 => Some(0.0),
                _ => None,
            },
            broken: match input.ratio(1, 8)? {
                true => Broken::Drop,
                false => Broken::Refuse,
            },
        };
        Ok(shape)
    }
}

impl Shape {
    /// The mesh, measured, or nothing where it is refused.
    pub fn mesh(&self) -> Option<TriangleMesh> {
        let repaired = TriangleMesh::repaired(self.vertices.clone(), &self.triangles, &self.repair);
        let mesh = unless_refused(repaired)?;
        self.check_repair(&mesh);
        assert!(mesh.area() > 0.0 && mesh.area().is_finite());
        assert_finite("areas of faces", mesh.face_areas());
        assert_finite("areas of vertices", mesh.vertex_areas());
        assert!(mesh.face_areas().iter().all(|&area| area >= 0.0));
        let sum: f64 = mesh.vertex_areas().iter().sum();
        assert!((sum / mesh.area() - 1.0).abs() < 1e-12);
        Some(mesh)
    }

    /// What was joined, split and dropped, and nothing else, has changed.
    fn check_repair(&self, mesh: &TriangleMesh) {
        let found = *mesh.findings();
        let triangles = self.triangles.len() - found.dropped_triangles + found.closed_junctions;
        assert_eq!(mesh.triangles().len(), triangles);
        assert!(found.open_edges <= found.open_edges_before);
        assert!(!found.to_string().is_empty());
        for doubt in mesh.doubts(self.repair.weld) {
            assert!(doubt.to_string().len() > 10);
        }
        let Some(map) = mesh.weld_map() else {
            assert!(!found.is_repaired());
            assert_eq!(mesh.vertices(), self.vertices);
            return;
        };
        assert_eq!(map.len(), self.vertices.len());
        let dropped = map.iter().filter(|place| place.is_none()).count();
        assert_eq!(dropped, found.dropped_vertices);
        let last = map.iter().flatten().max().expect("a vertex is left");
        assert_eq!(*last as usize + 1, mesh.vertex_count());
        let again: Vec<_> = mesh.triangles().iter().map(|t| t.map(i64::from)).collect();
        let again = TriangleMesh::repaired(mesh.vertices().to_vec(), &again, &self.repair);
        assert!(!again.expect("it was a mesh").findings().is_repaired());
    }

    fn hurt(&mut self, input: &mut Unstructured) -> Result<()> {
        let vertex = input.choose_index(self.vertices.len())?;
        match input.int_in_range(0..=6)? {
            0 => self.vertices[vertex] = point(input)?,
            1 => self.vertices[vertex] = self.vertices[input.choose_index(self.vertices.len())?],
            2 => self.vertices.push(point(input)?),
            3 => {
                let axis = input.choose_index(3)?;
                let factor = number(input)?;
                self.vertices.iter_mut().for_each(|p| p[axis] *= factor);
            }
            4 => {
                let triangle = *input.choose(&self.triangles)?;
                self.triangles.push(triangle);
            }
            5 => {
                let triangle = input.choose_index(self.triangles.len())?;
                self.triangles[triangle][input.choose_index(3)?] = vertex as i64;
            }
            _ => {
                let triangle = input.choose_index(self.triangles.len())?;
                self.triangles[triangle][0] = i64::from(input.arbitrary::<i8>()?);
            }
        }
        Ok(())
    }
}

fn grid(input: &mut Unstructured) -> Result<Shape> {
    let (rows, columns) = (input.int_in_range(2..=6)?, input.int_in_range(2..=6_i64)?);
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            vertices.push([column as f64, row as f64, number(input)?]);
            if row > 0 && column > 0 {
                let d = row * columns + column;
                let (a, b, c) = (d - columns - 1, d - columns, d - 1);
                triangles.extend([[a, b, d], [a, d, c]]);
            }
        }
    }
    Ok(Shape {
        vertices,
        triangles,
        repair: Repair::default(),
    })
}

/// Two cones on one ring.
fn bipyramid(input: &mut Unstructured) -> Result<Shape> {
    let sides = input.int_in_range(3..=12_i64)?;
    let mut vertices = vec![point(input)?, point(input)?];
    let mut triangles = Vec::new();
    for side in 0..sides {
        let angle = std::f64::consts::TAU * side as f64 / sides as f64;
        vertices.push([angle.cos(), angle.sin(), number(input)?]);
        let (a, b) = (2 + side, 2 + (side + 1) % sides);
        triangles.extend([[0, a, b], [1, b, a]]);
    }
    Ok(Shape {
        vertices,
        triangles,
        repair: Repair::default(),
    })
}

fn soup(input: &mut Unstructured) -> Result<Shape> {
    let count = input.int_in_range(1..=32)?;
    let vertices = (0..count).map(|_| point(input)).collect::<Result<_>>()?;
    let mut corner = || input.int_in_range(0..=count - 1);
    let mut triangles = Vec::new();
    for _ in 0..2 * count {
        triangles.push([corner()?, corner()?, corner()?]);
    }
    Ok(Shape {
        vertices,
        triangles,
        repair: Repair::default(),
    })
}
