//! Passes over faces that hardly move, at a fraction of what a look at them costs.

use crate::guard::face::{LEAST_AREA, NEEDLE, USUAL};

/// Faces that are judged at a time.
pub(super) const BLOCK: usize = 64;

/// What a face has left of its area if no corner moves, as seen from another, by more than this share
/// of its least height x: at least 1 − 2x − x² > [`LEAST_AREA`].
const CALM: f64 = 0.34;

/// Up to so many faces of a block are looked at without another judgement.
const FEW: usize = 8;

/// More than what rounding does to sums of products.
const ROUNDING: f64 = 1e-9;

/// What faces have to do to be looked at.
pub(super) struct Screen {
    stretch: f64,
    safe_gain: f64,
    /// The square of the stretch from which on a face is shown.
    most: f64,
    /// The square of the share of its least height by which a face may move unseen; -1 for none.
    share: f64,
}

/// One component of a vector of each of some faces.
type Values = [f64; BLOCK];
type Vectors = [Values; 3];
type Vector = [f64; 3];

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
    #[inline(always)]
    pub fn set(&mut self, place: usize, corners: [&[f64; 3]; 3], shifts: [&[f64; 3]; 3]) {
        for axis in 0..3 {
            for (edge, end) in [(0, 1), (1, 2)] {
                self.edges[edge][axis][place] = corners[end][axis] - corners[0][axis];
                self.changes[edge][axis][place] = shifts[end][axis] - shifts[0][axis];
            }
        }
    }

    /// The edges of a face, and their changes.
    #[inline(always)]
    fn at(&self, place: usize) -> [[Vector; 2]; 2] {
        let vector = |of: &Vectors| [of[0][place], of[1][place], of[2][place]];
        [&self.edges, &self.changes].map(|of| [vector(&of[0]), vector(&of[1])])
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
            stretch,
            safe_gain,
            most: largest.min(stretch).powi(2),
            share: if share > 0.0 { share * share } else { -1.0 },
        }
    }

    /// Of every face, a number that is not above 0 only if it may be passed over. Judged by the largest
    /// movement first; where many move much, by all of them.
    #[inline(always)]
    pub fn judge(&self, faces: &Block) -> Values {
        let mut excess = [0.0; BLOCK];
        for (k, excess) in excess.iter_mut().enumerate() {
            *excess = self.judge_height(faces.at(k));
        }
        let is_close = excess.iter().filter(|&&excess| excess > 0.0).count() > FEW;
        if is_close && self.safe_gain.is_finite() {
            for (k, excess) in excess.iter_mut().enumerate() {
                *excess = self.judge_motion(faces.at(k));
            }
        }
        excess
    }

    #[inline(always)]
    fn judge_height(&self, [[a, b], [u, v]]: [[Vector; 2]; 2]) -> f64 {
        // The least height is the normal's length over the longest edge.
        let longest = |a, b| larger(larger(square(a), square(b)), square(minus(b, a)));
        longest(a, b) * longest(u, v) - self.share * square(cross(a, b))
    }

    /// By the polynomials of [`crate::guard::face`], with a little less than they allow.
    #[inline(always)]
    fn judge_motion(&self, [[a, b], [u, v]]: [[Vector; 2]; 2]) -> f64 {
        let gain = self.safe_gain;
        let edges = [a, b, minus(b, a)];
        let changes = [u, v, minus(v, u)];
        let longest = larger(larger(square(a), square(b)), square(edges[2]));
        let normal = cross(a, b);
        let area = square(normal);
        let linear = dot(normal, cross(a, v)) + dot(normal, cross(u, b));
        let quadratic = dot(normal, cross(u, v));
        // Turned at gain 1.
        let size = area + linear.abs() + quadratic.abs();
        let mut excess = ROUNDING * size - (area + linear + quadratic);
        // Not safe.
        let loss = gain * (smaller(linear, 0.0) + gain * smaller(quadratic, 0.0));
        excess = larger(excess, -loss - (1.0 - ROUNDING) * (1.0 - LEAST_AREA) * area);
        for (edge, change) in edges.into_iter().zip(changes) {
            let (length, along, moved) = (square(edge), dot(edge, change), square(change));
            let least = larger(length, NEEDLE * NEEDLE * longest) * (1.0 - ROUNDING);
            let at = |gain: f64| length + gain * (2.0 * along + gain * moved);
            excess = larger(excess, at(1.0) - least * self.most);
            excess = larger(excess, at(gain) - least * self.stretch * self.stretch);
            // Products that may overflow.
            excess = larger(excess, moved - *USUAL.end());
        }
        // A needle, or of no usual size.
        excess = larger(
            excess,
            NEEDLE * NEEDLE * longest * longest * (1.0 + ROUNDING) - area,
        );
        excess = larger(excess, *USUAL.start() - longest);
        larger(excess, longest - *USUAL.end())
    }
}

#[inline(always)]
fn minus(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline(always)]
fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn square(a: Vector) -> f64 {
    dot(a, a)
}

/// Faster than what takes care of NaN.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}
