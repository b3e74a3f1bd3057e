//! Faces that a displacement folds or stretches, and the gain up to which none does.

use std::ops::Range;

use ndarray::ArrayView2;

use crate::error::Result;
use crate::guard::displaced::Displaced;
use crate::guard::face::Face;
use crate::guard::screen::{BLOCK, Screen};
use crate::guard::stretch::check_stretch;
use crate::memory::needs;
use crate::mesh::TriangleMesh;
use crate::monitor::{Monitor, Stage};
use crate::parallel;

/// One of so many faces is looked at first.
const SAMPLE: usize = 64;

/// What a displacement does to the faces of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Folds {
    /// Faces whose normals turn by over 90° against the mesh as it is, in order.
    pub flipped: Vec<usize>,
    /// Faces with an edge that becomes longer than the limit allows, in order.
    pub stretched: Vec<usize>,
    /// The largest length of an edge relative to what it was; 0 if no face has a size.
    pub largest_stretch: f64,
    /// The least positive gain of the displacement at which a face folds but for a margin, or an
    /// edge reaches the limit: below it nothing folds or stretches. Infinity if there is none.
    pub safe_gain: f64,
}

/// The faces of `mesh` that fold or stretch where its vertices move by `displacement` (3, V).
///
/// - A face folds where its normal turns by over 90° against the mesh as it is. The margin of the
///   safe gain is that a fifth of its area is left, as seen along its normal.
/// - A face is stretched where an edge becomes longer than `stretch` times its length. Edges may
///   become shorter: a face that collapses has reached the margin of folding before.
/// - A face that is lower than 1e-5 of its longest edge, such as one with no area, has no normal that
///   counts: it cannot fold. An edge that is shorter than that counts as if it were so long. A
///   face that repeats an index, or is no larger than a point, takes no part.
///
/// Takes some nanoseconds a face, so that it can follow a slider.
///
/// # Errors
/// If the displacement is not of this mesh or not finite, `stretch` is not above 1, or memory does
/// not suffice.
pub fn folds(mesh: &TriangleMesh, displacement: ArrayView2<f64>, stretch: f64) -> Result<Folds> {
    folds_with(mesh, displacement, stretch, Monitor::new().whole())
}

/// [`folds`], watched: `stage` cancels it.
///
/// # Errors
/// As [`folds`], or [`crate::Error::Cancelled`].
pub fn folds_with(
    mesh: &TriangleMesh,
    displacement: ArrayView2<f64>,
    stretch: f64,
    stage: Stage,
) -> Result<Folds> {
    check_stretch(stretch)?;
    stage.report(0.0)?;
    stage.claim(
        needs::folds(needs::Size::of(mesh)),
        &format!("looking at {} faces", mesh.triangles().len()),
        "take a mesh of fewer faces",
    )?;
    let displaced = Displaced::new(mesh, displacement)?;
    let count = mesh.triangles().len();
    // Faces that do no worse than these are passed over.
    let some = (0..count).step_by(SAMPLE * BLOCK);
    let some = some.map(|first| first..count.min(first + BLOCK));
    let some = some.fold(Part::new(stretch), |part, faces| {
        part.with(&displaced, faces)
    });
    let look = |faces| some.emptied().with(&displaced, faces);
    let parts = stage.pass(|| parallel::parts(count, look))?;
    stage.report(1.0)?;
    let faces = |of: fn(&Part) -> &Vec<usize>| parts.iter().flat_map(of).copied().collect();
    let largest = parts.iter().map(|part| part.squared_stretch);
    let safe = parts.iter().map(|part| part.safe_gain);
    Ok(Folds {
        flipped: faces(|part| &part.flipped),
        stretched: faces(|part| &part.stretched),
        largest_stretch: largest.fold(0.0, f64::max).sqrt(),
        safe_gain: safe.fold(f64::INFINITY, f64::min),
    })
}

/// The same of some faces.
struct Part {
    stretch: f64,
    flipped: Vec<usize>,
    stretched: Vec<usize>,
    squared_stretch: f64,
    safe_gain: f64,
}

impl Part {
    /// Of none.
    fn new(stretch: f64) -> Self {
        Self {
            stretch,
            flipped: Vec::new(),
            stretched: Vec::new(),
            squared_stretch: 0.0,
            safe_gain: f64::INFINITY,
        }
    }

    /// The same extremes without faces.
    fn emptied(&self) -> Self {
        Self {
            squared_stretch: self.squared_stretch,
            safe_gain: self.safe_gain,
            ..Self::new(self.stretch)
        }
    }

    fn with(mut self, displaced: &Displaced, faces: Range<usize>) -> Self {
        let screen = self.screen();
        displaced.for_each_face(faces, &displaced.shifts, screen, |index, face, screen| {
            if self.add(index, face) {
                *screen = self.screen();
            }
        });
        self
    }

    /// Adds a face; whether it is an extreme.
    fn add(&mut self, index: usize, face: &Face) -> bool {
        if face.is_flipped() {
            self.flipped.push(index);
        }
        let square = face.squared_stretch();
        if square > self.stretch * self.stretch {
            self.stretched.push(index);
        }
        let safe_gain = face.safe_gain(self.stretch, self.safe_gain);
        let is_extreme = square > self.squared_stretch || safe_gain < self.safe_gain;
        self.squared_stretch = self.squared_stretch.max(square);
        self.safe_gain = safe_gain;
        is_extreme
    }

    /// What faces have to do to add to what is known.
    fn screen(&self) -> Screen {
        Screen::new(self.stretch, self.safe_gain, self.squared_stretch.sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::guard::DEFAULT_STRETCH;
    use ndarray::{Array2, array};

    /// A cube of two triangles a side, those at (1, 1, 1) divided at that corner.
    fn cube() -> TriangleMesh {
        let corner = |v: usize| [v & 1, v >> 1 & 1, v >> 2].map(|x| x as f64);
        let sides = [
            [7, 3, 1, 5],
            [7, 6, 2, 3],
            [7, 5, 4, 6],
            [0, 2, 6, 4],
            [0, 4, 5, 1],
            [0, 1, 3, 2],
        ];
        let triangles = sides
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        let triangles: Vec<[i64; 3]> = triangles.collect();
        TriangleMesh::new((0..8).map(corner).collect(), &triangles).unwrap()
    }

    /// The displacement that moves one vertex.
    fn moving(mesh: &TriangleMesh, vertex: usize, by: [f64; 3]) -> Array2<f64> {
        let mut displacement = Array2::zeros((3, mesh.vertex_count()));
        (0..3).for_each(|axis| displacement[[axis, vertex]] = by[axis]);
        displacement
    }

    #[test]
    fn a_corner_that_is_pushed_through_a_cube_flips_its_six_faces() {
        let mesh = cube();
        // They are flat where the corner has reached the one opposite.
        let pushed = |way: f64| folds(&mesh, moving(&mesh, 7, [-way; 3]).view(), 9.0).unwrap();
        assert_eq!(pushed(0.999).flipped, []);
        let through = pushed(1.001);
        assert_eq!(through.flipped, [0, 1, 2, 3, 4, 5]);
        assert_eq!(through.stretched, []);
        // A fifth of the area is left at 0.8 of the way.
        assert!((pushed(1.0).safe_gain - 0.8).abs() < 1e-14);
        assert!((pushed(0.1).safe_gain - 8.0).abs() < 1e-13);
    }

    #[test]
    fn a_corner_that_is_drawn_out_stretches_the_edges_at_it() {
        let mesh = cube();
        let drawn = |way: f64| folds(&mesh, moving(&mesh, 7, [way, 0.0, 0.0]).view(), 2.0).unwrap();
        assert!((drawn(0.5).largest_stretch - 1.5).abs() < 1e-14);
        assert!((drawn(0.5).safe_gain - 2.0).abs() < 1e-14);
        assert_eq!(drawn(0.5).stretched, []);
        // Of the triangles at the edge from (0, 1, 1): one above and one beside.
        let found = drawn(1.1);
        let at_edge = |face: &usize| {
            let corners = mesh.triangles()[*face];
            corners.contains(&7) && corners.contains(&6)
        };
        assert_eq!(found.stretched, (0..12).filter(at_edge).collect::<Vec<_>>());
        assert_eq!(found.stretched.len(), 2);
        assert_eq!(found.flipped, []);
    }

    #[test]
    fn what_shrinks_to_a_point_is_safe_until_a_fifth_of_the_area_is_left() {
        let mesh = cube();
        let shape = Array2::from_shape_fn((3, 8), |(axis, v)| mesh.vertices()[v][axis]);
        let found = folds(&mesh, (-&shape).view(), DEFAULT_STRETCH).unwrap();
        assert!((found.safe_gain - (1.0 - 0.2_f64.sqrt())).abs() < 1e-14);
        assert_eq!((found.flipped.len(), found.largest_stretch), (0, 0.0));
        let found = folds(&mesh, shape.view(), DEFAULT_STRETCH).unwrap();
        assert!((found.safe_gain - 1.5).abs() < 1e-14);
        assert!((found.largest_stretch - 2.0).abs() < 1e-14);
    }

    #[test]
    fn what_does_not_change_shape_is_safe_at_any_gain() {
        let mesh = cube();
        let found = folds(&mesh, Array2::from_elem((3, 8), 7.0).view(), 1.5).unwrap();
        assert_eq!(
            (found.safe_gain, found.largest_stretch),
            (f64::INFINITY, 1.0)
        );
    }

    #[test]
    fn faces_without_a_normal_do_not_fold_and_points_do_not_stretch() {
        // A face in one line, one in one point, one that repeats an index, and one that is sound.
        let vertices = vec![
            [0., 0., 0.],
            [1., 0., 0.],
            [2., 0., 0.],
            [5., 5., 5.],
            [5., 5., 5.],
            [5., 5., 5.],
            [0., 1., 0.],
        ];
        let triangles = [[0, 1, 2], [3, 4, 5], [0, 0, 6], [0, 1, 6]];
        let mesh = TriangleMesh::new(vertices, &triangles).unwrap();
        let moved = array![
            [0.0, 0.0, 0.0, 9.0, 0.0, 0.0, 0.0],
            [0.0, 0.1, 0.0, 0.0, 9.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, 0.0, 9.0, 0.0]
        ];
        let found = folds(&mesh, moved.view(), DEFAULT_STRETCH).unwrap();
        assert_eq!((found.flipped, found.stretched), (vec![], vec![]));
        // The edge from (0, 1, 0) to (1, 0, 0), which is moved to (1, 0.1, 0), becomes shorter.
        assert!((found.largest_stretch - 1.01_f64.sqrt()).abs() < 1e-12);
        // Two corners at one place come apart: from 1e-5 of the longest edge they are stretched.
        let triangles = [[0, 1, 2], [0, 2, 3]];
        let vertices = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 1., 0.]];
        let mesh = TriangleMesh::new(vertices, &triangles).unwrap();
        for (apart, stretched) in [(2.4e-5, vec![]), (2.6e-5, vec![1])] {
            let displacement = moving(&mesh, 3, [apart, 0.0, 0.0]);
            let found = folds(&mesh, displacement.view(), DEFAULT_STRETCH).unwrap();
            assert_eq!((found.flipped, found.stretched), (vec![], stretched));
        }
    }

    #[test]
    fn sizes_make_no_difference() {
        let mesh = cube();
        let push = moving(&mesh, 7, [-1.5, 0.2, 0.1]);
        let expected = folds(&mesh, push.view(), DEFAULT_STRETCH).unwrap();
        assert_eq!(expected.flipped.len(), 2);
        for size in [1e-69, 1e-40, 1e-9, 1e9, 1e40] {
            let vertices = mesh
                .vertices()
                .iter()
                .map(|p| p.map(|x| size * x))
                .collect();
            let triangles: Vec<_> = mesh.triangles().iter().map(|t| t.map(i64::from)).collect();
            let scaled = TriangleMesh::new(vertices, &triangles).unwrap();
            let found = folds(&scaled, (size * &push).view(), DEFAULT_STRETCH).unwrap();
            assert_eq!(found.flipped, expected.flipped);
            assert_eq!(found.stretched, expected.stretched);
            assert!((found.safe_gain / expected.safe_gain - 1.0).abs() < 1e-12);
            assert!((found.largest_stretch / expected.largest_stretch - 1.0).abs() < 1e-12);
        }
        // So large a displacement that squares would overflow.
        let found = folds(&mesh, (1e99 * &push).view(), DEFAULT_STRETCH).unwrap();
        assert!((found.safe_gain * 1e99 / expected.safe_gain - 1.0).abs() < 1e-12);
        assert!(found.largest_stretch > 1e98 && found.largest_stretch.is_finite());
        let found = folds(&mesh, (1e-99 * &push).view(), DEFAULT_STRETCH).unwrap();
        assert!((found.safe_gain * 1e-99 / expected.safe_gain - 1.0).abs() < 1e-12);
    }

    #[test]
    fn faces_that_are_passed_over_add_nothing() {
        let mut random = fastrand::Rng::with_seed(4);
        let size = 90;
        let at = |k: usize, j: usize| (size * k + j) as i64;
        let cells = (1..size).flat_map(|k| (1..size).map(move |j| (k, j)));
        let triangles: Vec<[i64; 3]> = cells
            .flat_map(|(k, j)| {
                let [a, b, c, d] = [at(k - 1, j - 1), at(k, j - 1), at(k, j), at(k - 1, j)];
                [[a, b, c], [a, c, d]]
            })
            .collect();
        let vertices = (0..size * size).map(|v| [v / size, v % size, 0]);
        let vertices = vertices.map(|p| p.map(|x| x as f64 + 0.2 * random.f64()));
        let mesh = TriangleMesh::new(vertices.collect(), &triangles).unwrap();
        for (most, calm) in [
            (1.0, 0.2),
            (4.0, 0.01),
            (0.3, 0.3),
            (0.01, 0.01),
            (9.0, 0.0),
        ] {
            let wild = |v: usize| if v.is_multiple_of(97) { most } else { calm };
            let moved =
                Array2::from_shape_fn((3, size * size), |(_, v)| wild(v) * (random.f64() - 0.5));
            let displaced = Displaced::new(&mesh, moved.view()).unwrap();
            let faces = 0..triangles.len();
            let mut expected = Part::new(DEFAULT_STRETCH);
            let all = Screen::new(DEFAULT_STRETCH, f64::INFINITY, 0.0);
            displaced.for_each_face(faces, &displaced.shifts, all, |index, face, _| {
                expected.add(index, face);
            });
            let found = folds(&mesh, moved.view(), DEFAULT_STRETCH).unwrap();
            assert_eq!(found.flipped, expected.flipped);
            assert_eq!(found.stretched, expected.stretched);
            assert_eq!(found.largest_stretch, expected.squared_stretch.sqrt());
            assert_eq!(found.safe_gain, expected.safe_gain);
        }
    }

    #[test]
    fn what_is_no_displacement_or_no_limit_is_refused() {
        let mesh = cube();
        let refusal = |displacement: Array2<f64>, stretch| {
            folds(&mesh, displacement.view(), stretch)
                .unwrap_err()
                .to_string()
        };
        let still = Array2::zeros((3, 8));
        for stretch in [1.0, 0.5, -2.0, f64::NAN, f64::INFINITY] {
            assert!(refusal(still.clone(), stretch).starts_with("stretch must be above 1"));
        }
        assert!(refusal(Array2::zeros((3, 7)), 2.5).contains("every vertex (8), but has 7"));
        let broken = moving(&mesh, 5, [0.0, f64::NAN, 0.0]);
        assert!(refusal(broken, 2.5).starts_with("the value of vertex 5, channel 1"));
    }
}
