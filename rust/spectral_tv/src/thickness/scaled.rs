//! A mesh in units of its own size, in its connected parts.

use std::sync::Arc;

use crate::mesh::{TriangleMesh, component_count};

/// A mesh about its middle, of the area 1.
pub(crate) struct Scaled {
    /// Positions of the vertices, V.
    pub points: Vec<[f64; 3]>,
    /// Index triples, F.
    pub triangles: Arc<[[u32; 3]]>,
    /// Areas of the triangles, F.
    pub areas: Vec<f64>,
    /// The triangles with area of each connected part that has any.
    pub parts: Vec<Vec<u32>>,
    /// The length that is 1 here.
    pub unit: f64,
}

impl Scaled {
    pub fn new(mesh: &TriangleMesh) -> Self {
        let (unit, area) = (mesh.area().sqrt(), mesh.area());
        let triangles = Arc::clone(mesh.triangles());
        let areas: Vec<f64> = mesh.face_areas().iter().map(|a| a / area).collect();
        let middle = middle(mesh);
        let points = mesh.vertices().iter();
        let points = points
            .map(|point| std::array::from_fn(|axis| (point[axis] - middle[axis]) / unit))
            .collect();
        let components = mesh.connected_components();
        let mut parts = vec![Vec::new(); component_count(&components)];
        for (face, triangle) in triangles.iter().enumerate() {
            if areas[face] > 0.0 {
                parts[components[triangle[0] as usize] as usize].push(face as u32);
            }
        }
        parts.retain(|part| !part.is_empty());
        Self {
            points,
            triangles,
            areas,
            parts,
            unit,
        }
    }

    /// The corners of a triangle.
    pub fn corners(&self, face: u32) -> [[f64; 3]; 3] {
        self.triangles[face as usize].map(|corner| self.points[corner as usize])
    }

    /// The distance between two vertices.
    pub fn distance(&self, one: u32, other: u32) -> f64 {
        square_distance(self.points[one as usize], self.points[other as usize]).sqrt()
    }

    /// Twice the area of a triangle along its normal.
    pub fn area_normal(&self, face: u32) -> [f64; 3] {
        let [p, q, r] = self.corners(face);
        cross(difference(q, p), difference(r, p))
    }

    /// The area of some triangles.
    pub fn area_of(&self, faces: &[u32]) -> f64 {
        faces.iter().map(|face| self.areas[*face as usize]).sum()
    }
}

/// The middle of the box around the mesh: its own distance from the origin takes no digits then.
pub(crate) fn middle(mesh: &TriangleMesh) -> [f64; 3] {
    std::array::from_fn(|axis| {
        let along = mesh.triangles().iter().flatten();
        let values = along.map(|corner| mesh.vertices()[*corner as usize][axis]);
        let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), x| {
            (least.min(x), most.max(x))
        });
        0.5 * (least + most)
    })
}

pub(crate) fn difference(p: [f64; 3], q: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| p[axis] - q[axis])
}

pub(crate) fn dot(p: [f64; 3], q: [f64; 3]) -> f64 {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

pub(crate) fn cross(p: [f64; 3], q: [f64; 3]) -> [f64; 3] {
    [
        p[1] * q[2] - p[2] * q[1],
        p[2] * q[0] - p[0] * q[2],
        p[0] * q[1] - p[1] * q[0],
    ]
}

/// |p − q|².
pub(crate) fn square_distance(p: [f64; 3], q: [f64; 3]) -> f64 {
    let between = difference(p, q);
    dot(between, between)
}

/// The point at `length` from `point` along `direction`.
pub(crate) fn along(point: [f64; 3], length: f64, direction: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| point[axis] + length * direction[axis])
}

/// The opposite direction.
pub(crate) fn inverse(direction: [f64; 3]) -> [f64; 3] {
    direction.map(|x| -x)
}
