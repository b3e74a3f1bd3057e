//! The triangle mesh every flow runs on: validated once, immutable afterwards.

mod components;
mod doubts;
#[cfg(test)]
pub(crate) mod examples;
mod findings;
mod intrinsic;
mod open_edges;
mod repair;
mod weld;

use std::ops::RangeInclusive;
use std::sync::{Arc, OnceLock};

use crate::error::{ArgumentError, Error, Result};
use crate::parallel;
use components::surface_count;
pub(crate) use components::{component_count, components_of};
pub use doubts::Doubt;
pub use findings::Findings;
pub(crate) use intrinsic::repeats_an_index;
use intrinsic::{embedded_lengths, enlarged, enlargement, face_area};
use open_edges::open_edges;
pub use repair::{Broken, Repair};
use repair::{Repaired, check_weld_map};

/// The areas of surfaces that can be worked with, length²: in Heron's formula products of lengths
/// lose no digits to underflow, and times of the order of the area are usable.
const USABLE_AREAS: RangeInclusive<f64> = 1e-140..=1e100;

/// A triangle mesh with V vertices and F triangles, and the metric g₀ of its shape.
///
/// Everything the mathematics needs is intrinsic: the lengths of each triangle's edges. They
/// are mollified where triangles are degenerate, so zero-area triangles, needles, boundaries,
/// non-manifold edges, several components and vertices in no triangle are all accepted.
/// Clones share what is long.
#[derive(Debug, Clone)]
pub struct TriangleMesh {
    vertices: Arc<[[f64; 3]]>,
    triangles: Arc<[[u32; 3]]>,
    /// Lengths of the edges opposite to each triangle's corners, where they are not distances.
    own_lengths: Option<Vec<[f64; 3]>>,
    /// What mollification adds to every edge.
    enlargement: f64,
    face_areas: Arc<[f64]>,
    vertex_areas: Arc<[f64]>,
    area: f64,
    /// Where the vertices that were handed in went, if they are not the same.
    weld_map: Option<Arc<[Option<u32>]>>,
    /// Counts of what was done, and of open edges; `None` where nothing was to be done.
    done: Option<Findings>,
    /// The same with what is counted only when it is asked for.
    findings: OnceLock<Findings>,
    /// The thickness at every vertex, once [`crate::thickness`] has measured it, or it was given.
    pub(crate) thickness: Arc<OnceLock<Vec<f64>>>,
}

impl TriangleMesh {
    /// Checks the input and measures the mesh.
    ///
    /// `vertices`: V positions; `triangles`: F index triples. A triangle that repeats an index
    /// spans no area and takes no part.
    ///
    /// # Errors
    /// Names the first vertex that is not finite, or beyond 1e100, or triangle whose index is out of range; or
    /// says that there are no triangles or that they span no area, or one below 1e-140 or
    /// beyond 1e100.
    pub fn new(vertices: Vec<[f64; 3]>, triangles: &[[i64; 3]]) -> Result<Self> {
        Self::repaired(vertices, triangles, &Repair::default())
    }

    /// The same after what `repair` says: the mesh may have fewer vertices and more or fewer
    /// triangles then. The first triangles are those handed in, in their order; the parts of
    /// those that were split are behind them, but for one each.
    ///
    /// # Errors
    /// As [`TriangleMesh::new`]; if a length is none, or no triangle is left.
    pub fn repaired(
        vertices: Vec<[f64; 3]>,
        triangles: &[[i64; 3]],
        repair: &Repair,
    ) -> Result<Self> {
        let ready = Repaired::new(vertices, triangles, repair)?;
        let mut mesh = Self::measured(ready.vertices, ready.triangles, None)?;
        mesh.weld_map = ready.weld_map.map(Into::into);
        mesh.done = ready.findings;
        Ok(mesh)
    }

    /// A mesh of its parts, as [`Self::vertices`], [`Self::triangles`], [`Self::weld_map`] and
    /// [`Self::findings`] give them; `findings` are counted anew for `None`.
    ///
    /// # Errors
    /// As [`TriangleMesh::new`]; if the map leads out of the mesh.
    pub fn from_parts(
        vertices: Vec<[f64; 3]>,
        triangles: &[[i64; 3]],
        weld_map: Option<Vec<Option<u32>>>,
        findings: Option<Findings>,
    ) -> Result<Self> {
        let mut mesh = Self::new(vertices, triangles)?;
        if let Some(map) = &weld_map {
            check_weld_map(map, mesh.vertex_count())?;
        }
        mesh.weld_map = weld_map.map(Into::into);
        if let Some(findings) = findings {
            mesh.findings = findings.into();
        }
        Ok(mesh)
    }

    /// The same, measured by lengths of its own: `length` of the edge between two vertices, which
    /// may be that of an embedding in more dimensions.
    ///
    /// # Errors
    /// As [`TriangleMesh::new`].
    pub fn with_metric(
        vertices: Vec<[f64; 3]>,
        triangles: &[[i64; 3]],
        length: impl Fn(usize, usize) -> f64,
    ) -> Result<Self> {
        let Repaired {
            vertices,
            triangles,
            ..
        } = Repaired::new(vertices, triangles, &Repair::default())?;
        let lengths = |corners: &[u32; 3]| {
            let [p, q, r] = corners.map(|corner| corner as usize);
            [length(q, r), length(r, p), length(p, q)]
        };
        let own_lengths = triangles.iter().map(lengths).collect();
        Self::measured(vertices, triangles, Some(own_lengths))
    }

    /// The same mesh with a thickness of the shape, (V) lengths, in place of the measured one; see
    /// [`crate::thickness`].
    ///
    /// # Errors
    /// If there is not one length per vertex, or one is negative, not finite, or beyond 1e100.
    pub fn with_thickness(&self, thickness: Vec<f64>) -> Result<Self> {
        let count = self.vertex_count();
        if thickness.len() != count {
            let rule = format!("must have one value per vertex ({count})");
            return Err(ArgumentError::count("thickness", rule, thickness.len()).into());
        }
        if let Some(vertex) = thickness.iter().position(|r| !(0.0..=1e100).contains(r)) {
            let name = format!("thickness[{vertex}]");
            let rule = "must be 0 or more and at most 1e100";
            return Err(ArgumentError::value(name, rule, thickness[vertex]).into());
        }
        Ok(Self {
            thickness: Arc::new(OnceLock::from(thickness)),
            ..self.clone()
        })
    }

    /// The thickness, if it was measured or given.
    pub fn known_thickness(&self) -> Option<&[f64]> {
        self.thickness.get().map(Vec::as_slice)
    }

    fn measured(
        vertices: Vec<[f64; 3]>,
        triangles: Arc<[[u32; 3]]>,
        own_lengths: Option<Vec<[f64; 3]>>,
    ) -> Result<Self> {
        let lengths = |t: usize| raw_lengths(&vertices, &triangles, own_lengths.as_deref(), t);
        let enlargement = enlargement(&triangles, lengths);
        let face_areas = parallel::values(triangles.len(), |t| {
            face_area(enlarged(triangles[t], lengths(t), enlargement))
        });
        let area = face_areas.iter().sum::<f64>();
        if !USABLE_AREAS.contains(&area) {
            return Err(Error::Unusable(format!(
                "the {} triangles of the mesh span no area that can be measured ({area:e}; from \
                 {:e} to {:e} would do)",
                triangles.len(),
                USABLE_AREAS.start(),
                USABLE_AREAS.end()
            )));
        }
        let vertex_areas = barycentric_areas(vertices.len(), &triangles, &face_areas);
        Ok(Self {
            vertices: vertices.into(),
            triangles,
            own_lengths,
            enlargement,
            face_areas: face_areas.into(),
            vertex_areas: vertex_areas.into(),
            area,
            weld_map: None,
            done: None,
            findings: OnceLock::new(),
            thickness: Arc::default(),
        })
    }

    /// Number of vertices, V.
    pub fn vertex_count(&self) -> usize {
        self.vertices.len()
    }

    /// Positions of the vertices.
    pub fn vertices(&self) -> &[[f64; 3]] {
        &self.vertices
    }

    /// Index triples of the triangles.
    pub fn triangles(&self) -> &Arc<[[u32; 3]]> {
        &self.triangles
    }

    /// Lengths of the edges opposite to the corners of a triangle, mollified; all three 0 for
    /// one that repeats an index. Measured anew, as they are needed once.
    pub fn edge_lengths(&self, triangle: usize) -> [f64; 3] {
        let own = self.own_lengths.as_deref();
        let lengths = raw_lengths(&self.vertices, &self.triangles, own, triangle);
        enlarged(self.triangles[triangle], lengths, self.enlargement)
    }

    /// Area of each triangle, length².
    pub fn face_areas(&self) -> &[f64] {
        &self.face_areas
    }

    /// [`Self::face_areas`], to be shared.
    pub(crate) fn shared_face_areas(&self) -> &Arc<[f64]> {
        &self.face_areas
    }

    /// Barycentric area of each vertex: a third of its triangles', length². 0 for a vertex in
    /// no triangle.
    pub fn vertex_areas(&self) -> &[f64] {
        &self.vertex_areas
    }

    /// Area of the whole surface, length².
    pub fn area(&self) -> f64 {
        self.area
    }

    /// The number of every vertex's connected component, in the order of their first vertices. A
    /// triangle without area connects nothing; a vertex in no other is a component of its own.
    pub(crate) fn connected_components(&self) -> Vec<u32> {
        components_of(self.vertex_count(), &self.triangles, &self.face_areas)
    }

    /// Where each vertex that was handed in went, `None` for one that was dropped; `None` where all
    /// are what they were.
    pub fn weld_map(&self) -> Option<&[Option<u32>]> {
        self.weld_map.as_deref()
    }

    /// What was found and done when the mesh was read.
    pub fn findings(&self) -> &Findings {
        if self.findings.get().is_none() {
            let components = self.connected_components();
            let found = Findings {
                components: surface_count(&components, &self.triangles, &self.face_areas),
                ..self.done.unwrap_or_else(|| {
                    let border = open_edges(self.vertex_count(), &self.triangles);
                    Findings::of_border(&border)
                })
            };
            // Whoever was faster has found the same. It is kept at once, so that no process can be
            // forked while it is waited for.
            let _ = self.findings.set(found);
        }
        self.findings.get().expect("kept above")
    }
}

/// Lengths of the edges of a triangle before mollification.
fn raw_lengths(
    vertices: &[[f64; 3]],
    triangles: &[[u32; 3]],
    own_lengths: Option<&[[f64; 3]]>,
    triangle: usize,
) -> [f64; 3] {
    match own_lengths {
        Some(lengths) => lengths[triangle],
        None => embedded_lengths(vertices, triangles[triangle]),
    }
}

/// A third of every triangle's area to each of its corners.
pub(crate) fn barycentric_areas(
    vertex_count: usize,
    triangles: &[[u32; 3]],
    face_areas: &[f64],
) -> Vec<f64> {
    let mut areas = vec![0.0; vertex_count];
    for (triangle, area) in triangles.iter().zip(face_areas) {
        for &corner in triangle {
            areas[corner as usize] += area / 3.0;
        }
    }
    areas
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<[f64; 3]> {
        vec![[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]]
    }

    #[test]
    fn areas_of_a_unit_square() {
        let mesh = TriangleMesh::new(square(), &[[0, 1, 2], [0, 2, 3]]).unwrap();
        assert!((mesh.area() - 1.0).abs() < 1e-14);
        let expected = [1. / 3., 1. / 6., 1. / 3., 1. / 6.];
        for (area, expected) in mesh.vertex_areas().iter().zip(expected) {
            assert!((area - expected).abs() < 1e-14);
        }
    }

    #[test]
    fn refusals_name_the_element() {
        let mut vertices = square();
        let error = TriangleMesh::new(vertices.clone(), &[[0, 1, 2], [0, 2, 4]]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "triangle 1 refers to vertex 4, but the vertices are 0 to 3"
        );
        let error = TriangleMesh::new(vertices.clone(), &[[0, -1, 2]]).unwrap_err();
        assert!(error.to_string().contains("triangle 0 refers to vertex -1"));
        assert_eq!(error.triangles(), [0]);
        assert!(TriangleMesh::new(vertices.clone(), &[]).is_err());
        vertices[2][1] = f64::NAN;
        vertices[3][0] = f64::INFINITY;
        let error = TriangleMesh::new(vertices, &[[0, 1, 2]]).unwrap_err();
        assert!(error.to_string().starts_with("vertex 2 has a coordinate"));
        assert!(error.to_string().ends_with("; so it is with 1 more"));
        assert_eq!(error.vertices(), [2, 3]);
    }

    #[test]
    fn degenerate_triangles_are_given_a_metric() {
        let mut vertices = square();
        vertices.push([0.5, 0.0, 0.0]);
        let triangles = [[0, 1, 2], [0, 2, 3], [0, 4, 1], [1, 1, 2]];
        let mesh = TriangleMesh::new(vertices, &triangles).unwrap();
        assert!(mesh.face_areas()[2] > 0.0 && mesh.face_areas()[2] < 1e-2);
        assert_eq!(mesh.face_areas()[3], 0.0);
    }

    #[test]
    fn a_mesh_without_area_is_refused() {
        let error = TriangleMesh::new(vec![[1.0; 3]; 3], &[[0, 1, 2]]).unwrap_err();
        assert!(error.to_string().contains("span no area"));
    }

    #[test]
    fn sizes_that_leave_no_digits_are_refused() {
        let sized = |size: f64| {
            let vertices = square().iter().map(|p| p.map(|x| size * x)).collect();
            TriangleMesh::new(vertices, &[[0, 1, 2], [0, 2, 3]])
        };
        for size in [1e-80, 1e-71, 1e51, 1e80] {
            let error = sized(size).unwrap_err().to_string();
            assert!(error.ends_with("from 1e-140 to 1e100 would do)"), "{error}");
        }
        for size in [1e-69, 1e49] {
            assert!((sized(size).unwrap().area() / (size * size) - 1.0).abs() < 1e-14);
        }
    }
}
