//! Checks and repairs given vertices and triangles, so that they make a mesh.

use std::sync::Arc;

use crate::error::{ArgumentError, Error, Result, has_usable_size};
use crate::mesh::findings::{Findings, counted, counted_as, grouped};
use crate::mesh::open_edges::open_edges;
use crate::mesh::weld::{check_tolerance, weld};
use crate::named::named;

/// What is done to a mesh when it is read.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Repair {
    /// Surfaces are joined along open edges that are within this length of one another; at
    /// exactly the same place alone for 0; not at all for `None`.
    ///
    /// Corners on open edges (of one triangle only) become one where they are within the length,
    /// the nearest first, and an open edge is split at the corners of others that lie on it.
    /// However long it is, corners reach no farther than a quarter of their shortest edge.
    pub weld: Option<f64>,
    /// What becomes of vertices that are not finite.
    pub broken: Broken,
}

named! {
    /// What becomes of vertices that are not finite, or beyond 1e100.
    pub enum Broken: "broken" {
        /// A mesh with one is refused.
        #[default]
        Refuse = "refuse",
        /// They are dropped, with all their triangles.
        Drop = "drop",
    }
}

/// Where every vertex went.
pub(super) type WeldMap = Vec<Option<u32>>;

/// A mesh that is ready to be measured.
pub(super) struct Repaired {
    pub vertices: Vec<[f64; 3]>,
    pub triangles: Arc<[[u32; 3]]>,
    /// `None` where all vertices are where they were.
    pub weld_map: Option<WeldMap>,
    /// What was done; what was found is not counted yet.
    pub findings: Option<Findings>,
}

impl Repaired {
    /// Checks `vertices` and `triangles`, and does what `repair` says.
    ///
    /// # Errors
    /// As [`crate::mesh::TriangleMesh::repaired`], but for what it says of areas.
    pub fn new(vertices: Vec<[f64; 3]>, triangles: &[[i64; 3]], repair: &Repair) -> Result<Self> {
        if let Some(tolerance) = repair.weld {
            check_tolerance(tolerance)?;
        }
        check_count(&vertices)?;
        let broken = broken_vertices(&vertices);
        if let (Some(&first), Broken::Refuse) = (broken.first(), repair.broken) {
            return Err(Error::NonFiniteVertices {
                position: vertices[first],
                vertices: broken,
            });
        }
        let triangles = checked_triangles(triangles, vertices.len())?;
        let mut repaired = Self {
            vertices,
            triangles,
            weld_map: None,
            findings: None,
        };
        if !broken.is_empty() {
            repaired.drop_vertices(&broken)?;
        }
        if let Some(tolerance) = repair.weld {
            repaired.weld(tolerance);
        }
        Ok(repaired)
    }

    fn drop_vertices(&mut self, broken: &[usize]) -> Result<()> {
        let mut is_left = vec![true; self.vertices.len()];
        for &vertex in broken {
            is_left[vertex] = false;
        }
        let before = self.triangles.len();
        let is_whole = |triangle: &&[u32; 3]| triangle.iter().all(|&v| is_left[v as usize]);
        let left: Vec<_> = self.triangles.iter().filter(is_whole).copied().collect();
        if left.is_empty() {
            return Err(Error::Unusable(format!(
                "all {} of the mesh have a vertex that is not finite",
                counted(before, "triangle")
            )));
        }
        let dropped_triangles = before - left.len();
        let mut count = 0;
        let number = |is_left: bool| {
            count += u32::from(is_left);
            is_left.then(|| count - 1)
        };
        let map: WeldMap = is_left.iter().copied().map(number).collect();
        self.renumber(left, map);
        self.findings = Some(Findings {
            dropped_vertices: broken.len(),
            dropped_triangles,
            ..Findings::of_border(&open_edges(self.vertices.len(), &self.triangles))
        });
        Ok(())
    }

    fn weld(&mut self, tolerance: f64) {
        let vertices = std::mem::take(&mut self.vertices);
        let welded = weld(vertices, &self.triangles, tolerance);
        let dropped = self.findings.unwrap_or_default();
        self.findings = Some(Findings {
            dropped_vertices: dropped.dropped_vertices,
            dropped_triangles: dropped.dropped_triangles,
            ..welded.findings
        });
        self.vertices = welded.vertices;
        if welded.findings.joined_corners + welded.findings.closed_junctions == 0 {
            return;
        }
        let mut count = 0;
        let mut numbers = vec![0; welded.place.len()];
        for (vertex, &place) in welded.place.iter().enumerate() {
            if place as usize == vertex {
                numbers[vertex] = count;
                count += 1;
            }
        }
        let map = welded.place.iter();
        let map = map.map(|&place| Some(numbers[place as usize])).collect();
        self.renumber(welded.triangles, map);
    }

    /// Takes these `triangles`, and every vertex by its new number; of those that get the same one
    /// the first stays. Their corners have a number.
    fn renumber(&mut self, triangles: Vec<[u32; 3]>, map: WeldMap) {
        let number = |vertex: u32| map[vertex as usize].expect("corners are left");
        self.triangles = triangles.into_iter().map(|t| t.map(number)).collect();
        let mut count = 0;
        let numbered = std::mem::take(&mut self.vertices).into_iter().zip(&map);
        let left = numbered.filter(|(_, number)| {
            let is_new = **number == Some(count);
            count += u32::from(is_new);
            is_new
        });
        self.vertices = left.map(|(position, _)| position).collect();
        let earlier = self.weld_map.take();
        self.weld_map = Some(match earlier {
            None => map,
            Some(earlier) => {
                let then = |number: Option<u32>| number.and_then(|number| map[number as usize]);
                earlier.into_iter().map(then).collect()
            }
        });
    }
}

/// Refuses a map to other vertices than the first `vertex_count`.
pub(super) fn check_weld_map(map: &[Option<u32>], vertex_count: usize) -> Result<()> {
    let is_stray = |place: &Option<u32>| place.is_some_and(|place| place as usize >= vertex_count);
    match map.iter().position(is_stray) {
        None => Ok(()),
        Some(vertex) => Err(ArgumentError::contradiction(
            format!("weld_map[{vertex}]"),
            &["vertices"],
            format!(
                "the map of vertices leads from {vertex} out of the {}",
                counted_as(vertex_count, "vertex", "vertices")
            ),
        )
        .into()),
    }
}

/// Refuses more vertices than triangles can refer to.
fn check_count(vertices: &[[f64; 3]]) -> Result<()> {
    match u32::try_from(vertices.len()) {
        Ok(_) => Ok(()),
        Err(_) => Err(Error::Unusable(format!(
            "the mesh has {} vertices; the limit is {}",
            grouped(vertices.len()),
            u32::MAX
        ))),
    }
}

/// The vertices that are not finite, or beyond 1e100.
fn broken_vertices(vertices: &[[f64; 3]]) -> Vec<usize> {
    let is_broken = |vertex: &usize| !vertices[*vertex].iter().all(|x| has_usable_size(*x));
    (0..vertices.len()).filter(is_broken).collect()
}

fn checked_triangles(triangles: &[[i64; 3]], vertex_count: usize) -> Result<Arc<[[u32; 3]]>> {
    if triangles.is_empty() {
        return Err(Error::Unusable("the mesh has no triangles".into()));
    }
    if vertex_count == 0 {
        let message = "the mesh has triangles but no vertices";
        return Err(Error::Unusable(message.into()));
    }
    let valid = 0..vertex_count as i64;
    let stray = |triangle: usize| triangles[triangle].iter().find(|i| !valid.contains(i));
    let broken = |triangle: &usize| stray(*triangle).is_some();
    let broken: Vec<_> = (0..triangles.len()).filter(broken).collect();
    if let Some(&index) = broken.first().and_then(|&first| stray(first)) {
        return Err(Error::IndicesOutOfRange {
            triangles: broken,
            index,
            last: vertex_count - 1,
        });
    }
    Ok(triangles
        .iter()
        .map(|t| t.map(|index| index as u32))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::TriangleMesh;

    /// Two triangles that are half a millionth apart, and a corner that is broken.
    fn torn() -> (Vec<[f64; 3]>, [[i64; 3]; 3]) {
        let vertices = vec![
            [0., 0., 0.],
            [1., 0., 0.],
            [0., 1., 0.],
            [1., 0., 5e-7],
            [0., 1., 0.],
            [1., 1., 0.],
            [f64::NAN, 0., 0.],
        ];
        (vertices, [[0, 1, 2], [3, 5, 4], [0, 6, 1]])
    }

    #[test]
    fn broken_vertices_are_dropped_and_near_ones_joined() {
        let (vertices, triangles) = torn();
        let repaired = |weld, broken| {
            TriangleMesh::repaired(vertices.clone(), &triangles, &Repair { weld, broken })
        };
        let error = repaired(None, Broken::Refuse).unwrap_err();
        assert_eq!(error.vertices(), [6]);
        let mesh = repaired(None, Broken::Drop).unwrap();
        let (left, gone) = ((0..6).map(Some), [None]);
        let expected: Vec<_> = left.chain(gone).collect();
        assert_eq!(mesh.weld_map(), Some(&expected[..]));
        let mesh = repaired(Some(1e-6), Broken::Drop).unwrap();
        let places = [Some(0), Some(1), Some(2), Some(1), Some(2), Some(3), None];
        assert_eq!(mesh.weld_map(), Some(&places[..]));
        assert_eq!(mesh.vertices()[1], [1., 0., 2.5e-7]);
        assert_eq!(mesh.triangles()[..], [[0, 1, 2], [1, 3, 2]]);
        let text = "joined 4 of 6 corners at open edges; dropped 1 vertex that is not finite, and \
                    1 triangle there";
        assert_eq!(mesh.findings().to_string(), text);
        assert_eq!(mesh.findings().open_edges, 4);
    }

    #[test]
    fn a_mesh_can_be_put_together_of_its_parts() {
        let (vertices, triangles) = torn();
        let repair = Repair {
            weld: Some(1e-6),
            broken: Broken::Drop,
        };
        let mesh = TriangleMesh::repaired(vertices, &triangles, &repair).unwrap();
        let corners: Vec<_> = mesh.triangles().iter().map(|t| t.map(i64::from)).collect();
        let with = |map: Option<Vec<Option<u32>>>| {
            let vertices = mesh.vertices().to_vec();
            TriangleMesh::from_parts(vertices, &corners, map, Some(*mesh.findings()))
        };
        let again = with(mesh.weld_map().map(<[_]>::to_vec)).unwrap();
        assert_eq!(again.weld_map(), mesh.weld_map());
        assert_eq!(again.findings(), mesh.findings());
        assert_eq!(again.vertices(), mesh.vertices());
        let error = with(Some(vec![Some(0), None, Some(4)])).unwrap_err();
        assert!(error.to_string().contains("from 2 out of the 4 vertices"));
    }

    #[test]
    fn lengths_that_are_none_are_refused() {
        let (vertices, triangles) = torn();
        for weld in [-1.0, f64::NAN, f64::INFINITY] {
            let repair = Repair {
                weld: Some(weld),
                broken: Broken::Drop,
            };
            let error = TriangleMesh::repaired(vertices.clone(), &triangles, &repair).unwrap_err();
            assert!(
                error
                    .to_string()
                    .starts_with("weld must be a length of 0 or more")
            );
        }
    }
}
