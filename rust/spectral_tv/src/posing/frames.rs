//! How what is held is turned: by the faces whose corners are all given.

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};

use crate::mesh::TriangleMesh;
use crate::posing::model::Role;
use crate::posing::state::{aligned, normalized};

/// The faces between fixed vertices, at rest.
#[derive(Debug, Clone)]
pub(super) struct Frames {
    faces: Vec<Face>,
    is_at: Vec<bool>,
}

#[derive(Debug, Clone)]
struct Face {
    corners: [usize; 3],
    area: f64,
    positions: [Vector3<f64>; 3],
    frame: Matrix3<f64>,
}

impl Frames {
    /// Those of the vertices with [`Role::Fixed`].
    pub fn new(mesh: &TriangleMesh, roles: &[Role]) -> Self {
        let mut is_at = vec![false; roles.len()];
        let mut faces = Vec::new();
        for (triangle, &area) in mesh.triangles().iter().zip(mesh.face_areas()) {
            let corners = triangle.map(|corner| corner as usize);
            if area == 0.0 || corners.iter().any(|&v| roles[v] != Role::Fixed) {
                continue;
            }
            let positions = corners.map(|v| Vector3::from(mesh.vertices()[v]));
            let Some(frame) = frame(&positions) else {
                continue;
            };
            for vertex in corners {
                is_at[vertex] = true;
            }
            faces.push(Face {
                corners,
                area,
                positions,
                frame,
            });
        }
        Self { faces, is_at }
    }

    /// Whether a vertex is of such a face.
    pub fn are_at(&self, vertex: usize) -> bool {
        self.is_at[vertex]
    }

    /// The mean rotation of the faces around every vertex that are moved to `positions`.
    pub fn rotations(&self, positions: &[Vector3<f64>]) -> Vec<Quaternion<f64>> {
        let none = Quaternion::new(0.0, 0.0, 0.0, 0.0);
        let mut sums = vec![none; positions.len()];
        for face in &self.faces {
            let moved = face.corners.map(|v| positions[v]);
            let shifts = [0, 1, 2].map(|i| moved[i] - face.positions[i]);
            let turn = match shifts[1] == shifts[0] && shifts[2] == shifts[0] {
                true => Quaternion::identity(),
                false => match frame(&moved) {
                    Some(frame) => {
                        let rotation = frame * face.frame.transpose();
                        let rotation = Rotation3::from_matrix_unchecked(rotation);
                        UnitQuaternion::from_rotation_matrix(&rotation).into_inner()
                    }
                    None => continue,
                },
            };
            for vertex in face.corners {
                let sum = sums[vertex];
                sums[vertex] = sum + aligned(turn, &sum) * face.area;
            }
        }
        sums.into_iter().map(normalized).collect()
    }
}

/// An orthonormal frame of a triangle that turns with it, none where it has no area.
fn frame([p, q, r]: &[Vector3<f64>; 3]) -> Option<Matrix3<f64>> {
    let normal = (q - p).cross(&(r - p)).try_normalize(0.0)?;
    let along = (q - p).try_normalize(0.0)?;
    Some(Matrix3::from_columns(&[
        along,
        normal.cross(&along),
        normal,
    ]))
}
