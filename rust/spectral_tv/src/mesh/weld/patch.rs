//! The part of a mesh around some of its vertices.

use crate::mesh::weld::surface::Surface;

/// All triangles at some vertices, as a surface of its own, that can be joined at these.
pub(in crate::mesh) struct Patch {
    /// The surface; its first vertices are those chosen, in their order.
    pub surface: Surface,
    /// Its vertices in the mesh.
    vertices: Vec<u32>,
    /// Its triangles in the mesh.
    triangles: Vec<usize>,
}

impl Patch {
    /// The triangles at the `chosen` vertices, which increase. Where an edge leads from one of
    /// these to another, all triangles at it are there.
    pub fn at(chosen: &[u32], vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Self {
        let mut numbers = vec![u32::MAX; vertices.len()];
        let mut own_vertices = chosen.to_vec();
        for (&vertex, number) in chosen.iter().zip(0..) {
            numbers[vertex as usize] = number;
        }
        let mut own_triangles = Vec::new();
        let mut corners = Vec::new();
        for (index, triangle) in triangles.iter().enumerate() {
            let is_chosen = |&vertex: &u32| (numbers[vertex as usize] as usize) < chosen.len();
            if !triangle.iter().any(is_chosen) {
                continue;
            }
            corners.push(triangle.map(|vertex| {
                let number = &mut numbers[vertex as usize];
                if *number == u32::MAX {
                    *number = own_vertices.len() as u32;
                    own_vertices.push(vertex);
                }
                *number
            }));
            own_triangles.push(index);
        }
        let positions = own_vertices.iter().map(|&vertex| vertices[vertex as usize]);
        Self {
            surface: Surface::new(positions.collect(), corners, chosen.len()),
            vertices: own_vertices,
            triangles: own_triangles,
        }
    }

    /// Takes what became of it over into the mesh: positions, triangles, and of every vertex, the
    /// one that it is now.
    pub fn put_back(
        self,
        vertices: &mut [[f64; 3]],
        triangles: &mut Vec<[u32; 3]>,
        place: &mut [u32],
    ) {
        let own = |number: u32| self.vertices[number as usize];
        for (number, &now) in (0..).zip(self.surface.place()) {
            place[own(number) as usize] = own(now);
            vertices[own(number) as usize] = self.surface.vertices()[number as usize];
        }
        let (known, added) = self.surface.triangles().split_at(self.triangles.len());
        for (&index, corners) in self.triangles.iter().zip(known) {
            triangles[index] = corners.map(own);
        }
        triangles.extend(added.iter().map(|corners| corners.map(own)));
    }
}
