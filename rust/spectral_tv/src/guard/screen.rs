//! Passes over faces that hardly move, at a fraction of what a look at them costs.

use std::array;

/// Faces that are judged at a time.
pub(super) const BLOCK: usize = 64;

/// What a face has left of its area if no corner moves, as seen from another, by more than this share
/// of its least height x: at least 1 − 2x − x² > [`crate::guard::face::LEAST_AREA`].
const CALM: f64 = 0.34;

/// What faces have to do to be looked at.
pub(super) struct Screen {
    /// The square of the share of its least height by which a face may move unseen; -1 for none.
    share: f64,
}

/// One component of a vector of each of some faces.
type Values = [f64; BLOCK];
type Vectors = [Values; 3];

/// Some faces: two edges of each, from the same corner, and what the displacement adds to them.
pub(super) struct Block {
    edges: [Vectors; 2],
    changes: [Vectors; 2],
}

impl Block {
    pub fn new() -> Self {
        Self {
            edges: [[[0.0; BLOCK]; 3]; 2],
            changes: [[[0.0; BLOCK]; 3]; 2],
        }
    }

    /// Makes this the face at a place.
    #[inline]
    pub fn set(&mut self, place: usize, corners: [&[f64; 3]; 3], shifts: [&[f64; 3]; 3]) {
        for axis in 0..3 {
            for (edge, end) in [(0, 1), (1, 2)] {
                self.edges[edge][axis][place] = corners[end][axis] - corners[0][axis];
                self.changes[edge][axis][place] = shifts[end][axis] - shifts[0][axis];
            }
        }
    }
}

impl Screen {
    /// Shows faces that may be safe only up to less than `safe_gain`, or that may stretch beyond
    /// `largest`, or beyond `stretch`, at gain 1.
    pub fn new(stretch: f64, safe_gain: f64, largest: f64) -> Self {
        // No edge is shorter than the least height.
        let calm = CALM.min(stretch - 1.0);
        let share = calm.min(calm / safe_gain).min(largest - 1.0);
        // A little less, as all of it is rounded.
        let share = 0.999 * share;
        Self {
            share: if share > 0.0 { share * share } else { -1.0 },
        }
    }

    /// Of every face, a number that is not above 0 only if it may be passed over.
    pub fn judge(&self, faces: &Block) -> Values {
        let [a, b] = &faces.edges;
        let [u, v] = &faces.changes;
        let mut excess = [0.0; BLOCK];
        for (k, excess) in excess.iter_mut().enumerate() {
            let at = |vectors: &Vectors| [vectors[0][k], vectors[1][k], vectors[2][k]];
            let [a, b, u, v] = [at(a), at(b), at(u), at(v)];
            let normal = [
                a[1] * b[2] - a[2] * b[1],
                a[2] * b[0] - a[0] * b[2],
                a[0] * b[1] - a[1] * b[0],
            ];
            // The least height is the normal's length over the longest edge.
            *excess = longest(a, b) * longest(u, v) - self.share * square(normal);
        }
        excess
    }
}

/// The square of the longest of two sides of a triangle and its third.
#[inline]
fn longest(a: [f64; 3], b: [f64; 3]) -> f64 {
    let third = array::from_fn(|axis| b[axis] - a[axis]);
    larger(larger(square(a), square(b)), square(third))
}

#[inline]
fn square([x, y, z]: [f64; 3]) -> f64 {
    x * x + y * y + z * z
}

/// Faster than what takes care of NaN.
#[inline]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
