//! A ball that touches a surface from inside.

use rstar::RTree;

use crate::thickness::scaled::{along, difference, dot, inverse, square_distance};
use crate::thickness::search::{Region, Solid};

/// Times that a ball shrinks at most to avoid a solid.
const SHRINKINGS: usize = 40;
/// Relative change of a radius that ends it.
const ROUNDING: f64 = 1e-6;
/// What is nearer to a point than this is taken for itself.
const NEAREST: f64 = 1e-7;
/// The cosine between the points of contact from which on a ball lies between opposite sides.
const OPPOSITE: f64 = -0.86;

/// A ball that touches the surface from inside.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ball {
    pub center: [f64; 3],
    pub radius: f64,
    /// Whether it is that of a sheet or shell, which it may touch from either side.
    pub is_either_side: bool,
    /// The vertex next to the sample that it belongs to.
    pub vertex: u32,
    /// The point of the surface that it was put at.
    pub point: [f64; 3],
    /// Where it touches the surface besides; `point` where it does not.
    pub contact: [f64; 3],
    /// The cosine between both, seen from the center; 1 where there is one.
    pub cosine: f64,
}

impl Ball {
    /// Whether it lies between opposite sides.
    pub fn is_between(&self) -> bool {
        self.cosine <= OPPOSITE
    }

    pub fn smaller(self, other: Self) -> Self {
        if other.radius < self.radius {
            other
        } else {
            self
        }
    }

    /// Shrinks about its point until no solid of a tree is inside, and tells of each that it touches
    /// meanwhile.
    pub fn shrink<T: Solid>(
        &mut self,
        direction: [f64; 3],
        tree: &RTree<T>,
        mut touched: impl FnMut(&T),
    ) {
        let region = Region::new(self.center, self.radius);
        for solid in region.within(tree) {
            if self.avoid(direction, solid) {
                touched(solid);
                region.shrink(self.center, self.radius);
            }
        }
    }

    /// Shrinks about its point until a solid is not inside; whether it did.
    fn avoid(&mut self, direction: [f64; 3], solid: &impl Solid) -> bool {
        let mut shrank = false;
        for _ in 0..SHRINKINGS {
            let contact = solid.nearest(self.center);
            let square = self.radius * self.radius;
            if square_distance(contact, self.center) >= square * (1.0 - ROUNDING) {
                break;
            }
            let across = difference(contact, self.point);
            let depth = dot(across, direction);
            let radius = dot(across, across) / (2.0 * depth);
            let shrinks = radius > 0.0 && radius < self.radius * (1.0 - ROUNDING);
            let is_apart = dot(across, across) > NEAREST * NEAREST;
            if depth <= 0.0 || !shrinks || !is_apart {
                break;
            }
            let center = along(self.point, radius, direction);
            let cosine = dot(difference(contact, center), inverse(direction)) / radius;
            *self = Self {
                center,
                radius,
                contact,
                cosine,
                ..*self
            };
            shrank = true;
        }
        shrank
    }
}
