//! The per-face gradient G and its adjoint.

use std::sync::Arc;

use ndarray::ArrayView1;
use rayon::prelude::*;
use sprs::{CsMat, TriMat};

use crate::error::Result;
use crate::mesh::TriangleMesh;
use crate::monitor::Stage;
use crate::numbering::Numbering;
use crate::operators::grouped::grouped;
use crate::operators::side_by_side::{Lanes, SideBySide};
use crate::parallel;

/// Faces between two looks at whether the work was cancelled.
const PIECE: usize = 1 << 18;

/// A tangent vector of a face, in the face's own orthonormal frame, per unit of length.
pub type FaceVector = [f64; 2];

/// G: the gradients of the three hat functions on every face (2F × V as a matrix).
///
/// Those of a face sum to 0, so two of them are kept. Frames are intrinsic (first axis along the first
/// edge), so nothing here depends on where the mesh lies in space.
#[derive(Debug, Clone)]
pub struct Gradient {
    hats: Vec<[FaceVector; 2]>,
    triangles: Arc<[[u32; 3]]>,
    face_areas: Arc<[f64]>,
    vertex_count: usize,
}

impl Gradient {
    /// The gradient operator of the mesh's metric.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn new(mesh: &TriangleMesh, stage: Stage) -> Result<Self> {
        let areas = mesh.shared_face_areas();
        let mut hats = Vec::with_capacity(areas.len());
        for first in (0..areas.len()).step_by(PIECE) {
            stage.check()?;
            let faces = (first..areas.len().min(first + PIECE)).into_par_iter();
            hats.par_extend(faces.map(|face| hat_gradients(mesh.edge_lengths(face), areas[face])));
        }
        Ok(Self {
            hats,
            triangles: Arc::clone(mesh.triangles()),
            face_areas: Arc::clone(areas),
            vertex_count: mesh.vertex_count(),
        })
    }

    /// The same with vertices in another `numbering`, and faces in the order of their first vertices in it.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub(crate) fn numbered(
        mesh: &TriangleMesh,
        numbering: &Numbering,
        stage: Stage,
    ) -> Result<Self> {
        let corners = |triangle: &[u32; 3]| triangle.map(|v| numbering.places[v as usize]);
        let first = |triangle: &[u32; 3]| corners(triangle).into_iter().min().unwrap_or(0);
        let firsts = stage.pass(|| parallel::map(&mesh.triangles()[..], first))?;
        let (_, order) = grouped(&firsts, mesh.vertex_count(), stage)?;
        drop(firsts);
        let areas = mesh.face_areas();
        let mut hats = Vec::with_capacity(areas.len());
        for faces in order.chunks(PIECE) {
            stage.check()?;
            hats.par_extend(faces.par_iter().map(|&face| {
                let face = face as usize;
                hat_gradients(mesh.edge_lengths(face), areas[face])
            }));
        }
        let triangle = |face: &u32| corners(&mesh.triangles()[*face as usize]);
        let triangles = stage.pass(|| parallel::map(&order, triangle))?;
        let face_areas = stage.pass(|| parallel::map(&order, |face| areas[*face as usize]))?;
        let count = mesh.vertex_count();
        Ok(Self::of_functions(
            hats,
            triangles.into(),
            face_areas.into(),
            count,
        ))
    }

    /// That of other linear functions: N unknowns, three of them to each triangle, multiply functions whose
    /// gradients sum to 0; `hats` are those of the second and of the third.
    pub fn of_functions(
        hats: Vec<[FaceVector; 2]>,
        triangles: Arc<[[u32; 3]]>,
        face_areas: Arc<[f64]>,
        count: usize,
    ) -> Self {
        Self {
            hats,
            triangles,
            face_areas,
            vertex_count: count,
        }
    }

    /// Area of each face, length².
    pub fn face_areas(&self) -> &[f64] {
        &self.face_areas
    }

    /// Number of vertices, V.
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// Vertices of each face.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The same, shared.
    pub(crate) fn shared_triangles(&self) -> &Arc<[[u32; 3]]> {
        &self.triangles
    }

    /// Gradients of the three hat functions of a face.
    #[inline]
    pub fn hats(&self, face: usize) -> [FaceVector; 3] {
        let [j, k] = self.hats[face];
        [[-(j[0] + k[0]), -(j[1] + k[1])], j, k]
    }

    /// The same of the second and of the third of each face.
    pub fn later_hats(&self) -> &[[FaceVector; 2]] {
        &self.hats
    }

    /// ∇u of one channel on one face.
    #[inline]
    pub fn on_face(&self, face: usize, channel: &ArrayView1<f64>) -> FaceVector {
        let [i, j, k] = self.triangles[face];
        let corners = [
            &[channel[i as usize]],
            &[channel[j as usize]],
            &[channel[k as usize]],
        ];
        let [[x], [y]] = on_corners(&self.hats[face], corners);
        [x, y]
    }

    /// ∇u of one channel on every face.
    pub fn apply(&self, channel: ArrayView1<f64>) -> Vec<FaceVector> {
        (0..self.hats.len())
            .map(|face| self.on_face(face, &channel))
            .collect()
    }

    /// ∇u of the first channel of `values` on every face.
    pub fn vectors(&self, values: &SideBySide) -> Vec<FaceVector> {
        match values {
            SideBySide::One(lanes) => self.on_all(|face| self.on_lanes(face, lanes).map(|x| x[0])),
            SideBySide::Several { blocks, .. } => {
                self.on_all(|face| self.on_lanes(face, &blocks[0]).map(|x| x[0]))
            }
        }
    }

    /// |∇u| on every face, over all channels of `values` (C, V) together.
    pub fn norms(&self, values: &SideBySide) -> Vec<f64> {
        match values {
            SideBySide::One(lanes) => self.on_all(|face| self.square(face, lanes).sqrt()),
            SideBySide::Several { blocks, .. } => match &blocks[..] {
                [lanes] => self.on_all(|face| self.square(face, lanes).sqrt()),
                blocks => self.on_all(|face| {
                    let squares = blocks.iter().map(|lanes| self.square(face, lanes));
                    squares.sum::<f64>().sqrt()
                }),
            },
        }
    }

    /// ⟨∇a, ∇b⟩ and |∇b|² on every face, over all channels of `a` and `b` (C, V) together.
    ///
    /// # Panics
    /// If one has a single channel, and the other several.
    pub fn products(&self, a: &SideBySide, b: &SideBySide) -> Vec<[f64; 2]> {
        match (a, b) {
            (SideBySide::One(a), SideBySide::One(b)) => {
                self.on_all(|face| self.product(face, a, b))
            }
            (SideBySide::Several { blocks: a, .. }, SideBySide::Several { blocks: b, .. }) => {
                match (&a[..], &b[..]) {
                    ([a], [b]) => self.on_all(|face| self.product(face, a, b)),
                    (a, b) => self.on_all(|face| {
                        let blocks = a.iter().zip(b);
                        let products = blocks.map(|(a, b)| self.product(face, a, b));
                        products.fold([0.0; 2], |[p, q], [x, y]| [p + x, q + y])
                    }),
                }
            }
            _ => panic!("both functions have as many channels"),
        }
    }

    fn on_all<T: Send>(&self, value: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
        parallel::values(self.hats.len(), value)
    }

    #[inline(always)]
    fn square<const L: usize>(&self, face: usize, lanes: &[Lanes<L>]) -> f64 {
        let [x, y] = self.on_lanes(face, lanes);
        dot(&x, &x) + dot(&y, &y)
    }

    #[inline(always)]
    fn product<const L: usize>(&self, face: usize, a: &[Lanes<L>], b: &[Lanes<L>]) -> [f64; 2] {
        let ([p, q], [x, y]) = (self.on_lanes(face, a), self.on_lanes(face, b));
        [dot(&p, &x) + dot(&q, &y), dot(&x, &x) + dot(&y, &y)]
    }

    /// The two components of ∇u of all lanes on one face.
    #[inline(always)]
    fn on_lanes<const L: usize>(&self, face: usize, lanes: &[Lanes<L>]) -> [Lanes<L>; 2] {
        let [i, j, k] = self.triangles[face];
        let corners = [&lanes[i as usize], &lanes[j as usize], &lanes[k as usize]];
        on_corners(&self.hats[face], corners)
    }

    /// Gᵀ A z: the integrated negative divergence at every vertex of a field with one vector
    /// per face, which `field` gives.
    #[inline]
    pub fn adjoint(&self, field: impl Fn(usize) -> FaceVector) -> Vec<f64> {
        let mut divergence = vec![0.0; self.vertex_count];
        for (face, corners) in self.triangles.iter().enumerate() {
            for (&corner, flux) in corners.iter().zip(self.flux(face, field(face))) {
                divergence[corner as usize] += flux;
            }
        }
        divergence
    }

    /// What the vector [x, y] on one face adds to that at its corners.
    #[inline]
    pub fn flux(&self, face: usize, [x, y]: FaceVector) -> [f64; 3] {
        let area = self.face_areas[face];
        self.hats(face).map(|hat| area * (hat[0] * x + hat[1] * y))
    }

    /// Gᵀ A w G u of one channel: the weighted Laplacian applied without a matrix.
    pub fn weighted_laplacian(&self, weights: &[f64], channel: ArrayView1<f64>) -> Vec<f64> {
        self.adjoint(|face| {
            self.on_face(face, &channel)
                .map(|component| weights[face] * component)
        })
    }

    /// G as a sparse matrix: rows 2f and 2f + 1 give the vector of face f.
    pub fn matrix(&self) -> CsMat<f64> {
        let mut entries = TriMat::new((2 * self.hats.len(), self.vertex_count));
        for (face, corners) in self.triangles.iter().enumerate() {
            for (&corner, hat) in corners.iter().zip(self.hats(face)) {
                entries.add_triplet(2 * face, corner as usize, hat[0]);
                entries.add_triplet(2 * face + 1, corner as usize, hat[1]);
            }
        }
        entries.to_csr()
    }
}

#[inline(always)]
fn dot<const L: usize>(a: &Lanes<L>, b: &Lanes<L>) -> f64 {
    let mut sum = 0.0;
    for lane in 0..L {
        sum += a[lane] * b[lane];
    }
    sum
}

/// The two components of ∇u of all lanes on a face, from the values at its corners.
#[inline(always)]
fn on_corners<const L: usize>(
    [hat_j, hat_k]: &[FaceVector; 2],
    [i, j, k]: [&Lanes<L>; 3],
) -> [Lanes<L>; 2] {
    let mut gradient = [[0.0; L]; 2];
    for lane in 0..L {
        // Differences, so that adding a constant to u changes nothing.
        let (along_j, along_k) = (j[lane] - i[lane], k[lane] - i[lane]);
        gradient[0][lane] = hat_j[0] * along_j + hat_k[0] * along_k;
        gradient[1][lane] = hat_j[1] * along_j + hat_k[1] * along_k;
    }
    gradient
}

/// ∇λ of the second and of the third corner, from the triangle laid out in the plane; zero for a face
/// without area.
fn hat_gradients([a, b, c]: [f64; 3], area: f64) -> [FaceVector; 2] {
    if area == 0.0 {
        return [[0.0; 2]; 2];
    }
    let (x, y) = ((b * b + c * c - a * a) / (2.0 * c), 2.0 * area / c);
    let twice = 2.0 * area;
    [[y / twice, -x / twice], [0.0, c / twice]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::monitor::Monitor;
    use ndarray::Array2;

    #[test]
    fn the_identity_has_a_gradient_of_norm_sqrt_two() {
        let vertices = vec![[0., 0., 0.], [3., 0.5, 1.], [0.2, 2., -1.], [1., 1., 4.]];
        let triangles = [[0, 1, 2], [1, 3, 2]];
        let mesh = TriangleMesh::new(vertices.clone(), &triangles).unwrap();
        let positions = Array2::from_shape_fn((3, 4), |(c, v)| vertices[v][c]);
        let gradient = Gradient::new(&mesh, Monitor::new().whole()).unwrap();
        for norm in gradient.norms(&positions.view().into()) {
            assert!((norm - 2.0_f64.sqrt()).abs() < 1e-12);
        }
    }

    #[test]
    fn the_matrix_agrees_with_the_loops() {
        let vertices = vec![[0., 0., 0.], [1., 0., 0.], [0.3, 2., 0.5], [1., 1., -1.]];
        let mesh = TriangleMesh::new(vertices, &[[0, 1, 2], [1, 3, 2]]).unwrap();
        let gradient = Gradient::new(&mesh, Monitor::new().whole()).unwrap();
        let channel = ndarray::arr1(&[1.0, -2.0, 0.5, 3.0]);
        let product = &gradient.matrix() * &channel;
        for (face, vector) in gradient.apply(channel.view()).iter().enumerate() {
            assert!((product[2 * face] - vector[0]).abs() < 1e-13);
            assert!((product[2 * face + 1] - vector[1]).abs() < 1e-13);
        }
    }
}
