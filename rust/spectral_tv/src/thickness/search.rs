//! Searches of trees in a ball that shrinks meanwhile.

use std::cell::Cell;

use rstar::{AABB, PointDistance, RTree, RTreeObject, SelectionFunction};

use crate::thickness::samples::Obstacle;
use crate::thickness::triangle::Triangle;

/// What balls have no room for.
pub(super) trait Solid: RTreeObject<Envelope = AABB<[f64; 3]>> + PointDistance {
    /// The point of it that is nearest to a center.
    fn nearest(&self, center: [f64; 3]) -> [f64; 3];
}

impl Solid for Obstacle {
    fn nearest(&self, _: [f64; 3]) -> [f64; 3] {
        *self.geom()
    }
}

impl Solid for Triangle {
    fn nearest(&self, center: [f64; 3]) -> [f64; 3] {
        Self::nearest(self, center)
    }
}

/// The ball that is searched. What is outside is outside of any smaller ball in it too, so a search
/// goes on while it shrinks.
pub(super) struct Region {
    center: Cell<[f64; 3]>,
    square_radius: Cell<f64>,
}

impl Region {
    pub fn new(center: [f64; 3], radius: f64) -> Self {
        Self {
            center: Cell::new(center),
            square_radius: Cell::new(radius * radius),
        }
    }

    /// Goes on in a ball inside.
    pub fn shrink(&self, center: [f64; 3], radius: f64) {
        self.center.set(center);
        self.square_radius.set(radius * radius);
    }

    /// What of a tree is inside when the search comes to it.
    pub fn within<'a, T: Solid>(&'a self, tree: &'a RTree<T>) -> impl Iterator<Item = &'a T> {
        tree.locate_with_selection_function(self)
    }
}

impl<T: Solid> SelectionFunction<T> for &Region {
    fn should_unpack_parent(&self, envelope: &T::Envelope) -> bool {
        envelope.distance_2(&self.center.get()) < self.square_radius.get()
    }

    fn should_unpack_leaf(&self, solid: &T) -> bool {
        solid.distance_2(&self.center.get()) < self.square_radius.get()
    }
}
