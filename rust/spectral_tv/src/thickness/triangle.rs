//! A triangle in a tree of them.

use rstar::{AABB, PointDistance, RTreeObject};

use crate::thickness::scaled::{along, difference, dot, square_distance};

/// The corners of a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Triangle(pub [[f64; 3]; 3]);

impl Triangle {
    /// The point of it that is nearest to `point`, by the regions of its corners, edges and inside
    /// (Ericson 2005, Real-Time Collision Detection, Sec. 5.1.5).
    pub fn nearest(&self, point: [f64; 3]) -> [f64; 3] {
        let [a, b, c] = self.0;
        let (ab, ac) = (difference(b, a), difference(c, a));
        let to = |corner: [f64; 3]| {
            let from = difference(point, corner);
            (dot(ab, from), dot(ac, from))
        };
        let ((a1, a2), (b1, b2), (c1, c2)) = (to(a), to(b), to(c));
        if a1 <= 0.0 && a2 <= 0.0 {
            return a;
        }
        if b1 >= 0.0 && b2 <= b1 {
            return b;
        }
        if c2 >= 0.0 && c1 <= c2 {
            return c;
        }
        let (beyond_a, beyond_b, beyond_c) =
            (b1 * c2 - c1 * b2, c1 * a2 - a1 * c2, a1 * b2 - b1 * a2);
        if beyond_c <= 0.0 && a1 >= 0.0 && b1 <= 0.0 {
            return along(a, a1 / (a1 - b1), ab);
        }
        if beyond_b <= 0.0 && a2 >= 0.0 && c2 <= 0.0 {
            return along(a, a2 / (a2 - c2), ac);
        }
        let (from_b, from_c) = (b2 - b1, c1 - c2);
        if beyond_a <= 0.0 && from_b >= 0.0 && from_c >= 0.0 {
            return along(b, from_b / (from_b + from_c), difference(c, b));
        }
        let total = beyond_a + beyond_b + beyond_c;
        along(along(a, beyond_b / total, ab), beyond_c / total, ac)
    }
}

impl RTreeObject for Triangle {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_points(&self.0)
    }
}

impl PointDistance for Triangle {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        square_distance(self.nearest(*point), *point)
    }
}
