//! Pairs of boxes that meet.

use std::ops::Range;

use rayon::prelude::*;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, Envelope, RTree};

use crate::error::Result;
use crate::monitor::Stage;
use crate::parallel;

/// Boxes of a slab: few enough to be sorted between two looks whether to go on.
const SLAB: usize = 1 << 16;

/// A box that is known by its place in the order.
type Placed = GeomWithData<Rectangle<[f64; 3]>, u32>;

/// Things in boxes, known by their numbers.
pub(super) trait Boxes: Sync {
    /// How many there are.
    fn count(&self) -> usize;
    /// The box of one.
    fn envelope(&self, number: u32) -> AABB<[f64; 3]>;
}

/// Boxes in the order in which they begin along an axis, and a tree for each part of the order.
pub(super) struct Slabs<'a, B> {
    boxes: &'a B,
    /// The axis along which they extend farthest.
    axis: usize,
    /// Where each begins, and its number.
    order: Vec<(f64, u32)>,
    trees: Vec<RTree<Placed>>,
}

impl<'a, B: Boxes> Slabs<'a, B> {
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub fn new(boxes: &'a B, stage: Stage) -> Result<Self> {
        let count = boxes.count();
        let axis = stage.pass(|| longest_axis(boxes))?;
        let begin = |number| (boxes.envelope(number as u32).lower()[axis], number as u32);
        let mut order = stage.pass(|| parallel::values(count, begin))?;
        // The numbers make the order one of its own.
        stage
            .pass(|| order.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))))?;
        stage.report(0.3)?;
        let slabs = (0..count.div_ceil(SLAB)).into_par_iter();
        let tree = |slab| {
            let placed = |place: usize| {
                let envelope = boxes.envelope(order[place].1);
                Placed::new(envelope.into(), place as u32)
            };
            stage.pass(|| RTree::bulk_load(part(slab, count).map(placed).collect()))
        };
        let trees = slabs.map(tree).collect::<Result<_>>()?;
        stage.report(1.0)?;
        Ok(Self {
            boxes,
            axis,
            order,
            trees,
        })
    }

    /// How many slabs there are.
    pub fn count(&self) -> usize {
        self.trees.len()
    }

    /// Numbers of boxes in a slab, and of those after them in the order, that meet and of which
    /// something `is_true`: of each pair both.
    pub fn pairs(&self, slab: usize, is_true: impl Fn(u32, u32) -> bool + Sync + Send) -> Vec<u32> {
        let places = part(slab, self.order.len());
        let found = parallel::parts(places.len(), |range| {
            let mut found = Vec::new();
            for place in range.map(|place| places.start + place) {
                let number = self.order[place].1;
                let after = self.after(slab, place);
                for other in after.filter(|&other| is_true(number, other)) {
                    found.extend([number, other]);
                }
            }
            found
        });
        found.into_iter().flatten().collect()
    }

    /// Numbers of boxes after a place of a slab that meet the box there.
    fn after(&self, slab: usize, place: usize) -> impl Iterator<Item = u32> {
        let envelope = self.boxes.envelope(self.order[place].1);
        let end = envelope.upper()[self.axis];
        let trees = self.trees.iter().enumerate().skip(slab);
        let near = trees.take_while(move |(slab, _)| self.order[slab * SLAB].0 <= end);
        near.flat_map(move |(_, tree)| tree.locate_in_envelope_intersecting(&envelope))
            .map(|other| other.data as usize)
            .filter(move |&other| other > place)
            .map(|other| self.order[other].1)
    }
}

/// The places of a slab.
fn part(slab: usize, count: usize) -> Range<usize> {
    slab * SLAB..count.min((slab + 1) * SLAB)
}

fn longest_axis(boxes: &impl Boxes) -> usize {
    let parts = parallel::parts(boxes.count(), |part| {
        part.map(|number| boxes.envelope(number as u32))
            .reduce(|a, b| a.merged(&b))
    });
    let whole = parts.into_iter().flatten().reduce(|a, b| a.merged(&b));
    let extent = |axis: &usize| {
        let sides = whole
            .as_ref()
            .map(|all| all.upper()[*axis] - all.lower()[*axis]);
        sides.unwrap_or(0.0)
    };
    let longest = (0..3).max_by(|a, b| extent(a).total_cmp(&extent(b)));
    longest.expect("there are three")
}
