//! One face and how its corners move: whether it folds or stretches, and from which gain on.

use std::ops::RangeInclusive;

use nalgebra::Vector3;

/// What has to be left of a face's area, seen along its normal, for a gain to be safe. Nothing is
/// left at the gain at which it folds.
pub(super) const LEAST_AREA: f64 = 0.2;

/// A face that is lower than this share of its longest edge has no normal that counts, and a shorter
/// edge counts as if it were so long. That is what single precision tells of a face a hundredth the
/// size of the shape.
pub(super) const NEEDLE: f64 = 1e-5;

/// The square of the length from which on a face has a size at all.
const LEAST_SIZE: f64 = 1e-280;

/// Squares of lengths of which no product in here overflows, or vanishes where it matters.
pub(super) const USUAL: RangeInclusive<f64> = 1e-60..=1e60;

type Vector = Vector3<f64>;

/// A face, with the differences of its corners' displacements.
pub(super) struct Face {
    /// From corner 0 to 1, from 1 to 2, and from 2 to 0.
    edges: [Vector; 3],
    /// What a gain of 1 adds to each.
    changes: [Vector; 3],
    /// The sum of both.
    moved: [Vector; 3],
    /// The squares of the edges' lengths, none below what counts.
    squares: [f64; 3],
    /// Its length is twice the area; 0 for a needle.
    normal: Vector,
    /// The gain that changes edges by `changes`, which have a unit of their own if they are of no
    /// usual size.
    gain: f64,
    /// The unit of `moved` in that of the edges.
    moved_unit: f64,
}

impl Face {
    /// `None` for a face without any size: it takes no part.
    #[inline]
    pub fn new(corners: [&[f64; 3]; 3], shifts: [&[f64; 3]; 3]) -> Option<Self> {
        let edges = differences(corners);
        let longest = largest_square(&edges);
        let changes = differences(shifts);
        let change = largest_square(&changes);
        if USUAL.contains(&longest) && change <= *USUAL.end() {
            let moved = [
                edges[0] + changes[0],
                edges[1] + changes[1],
                edges[2] + changes[2],
            ];
            return Some(Self::measured(edges, changes, moved));
        }
        (longest >= LEAST_SIZE).then(|| Self::of_unusual_size(edges, changes))
    }

    #[inline]
    fn measured(edges: [Vector; 3], changes: [Vector; 3], moved: [Vector; 3]) -> Self {
        let [a, b, c] = squares(&edges);
        let longest = a.max(b).max(c);
        let least = NEEDLE * NEEDLE * longest;
        let normal = normal_of(&edges);
        // The normal is as long as the longest edge times the height over it.
        let has_normal = normal.norm_squared() >= least * longest;
        Self {
            edges,
            changes,
            moved,
            squares: [a.max(least), b.max(least), c.max(least)],
            normal: if has_normal { normal } else { Vector::zeros() },
            gain: 1.0,
            moved_unit: 1.0,
        }
    }

    /// In units of the longest edge and of the largest change.
    #[cold]
    fn of_unusual_size(edges: [Vector; 3], changes: [Vector; 3]) -> Self {
        let largest = |vectors: &[Vector; 3]| vectors.iter().map(Vector::amax).fold(0.0, f64::max);
        let length = largest(&edges);
        let change = match largest(&changes) {
            0.0 => length,
            change => change,
        };
        let larger = length.max(change);
        let moved = |k: usize| edges[k] / larger + changes[k] / larger;
        let face = Self::measured(
            edges.map(|edge| edge / length),
            changes.map(|vector| vector / change),
            std::array::from_fn(moved),
        );
        Self {
            gain: length / change,
            moved_unit: larger / length,
            ..face
        }
    }

    /// Whether its normal turns by over 90° at gain 1.
    pub fn is_flipped(&self) -> bool {
        normal_of(&self.moved).dot(&self.normal) < 0.0
    }

    /// The square of the largest stretch of its edges at gain 1.
    pub fn squared_stretch(&self) -> f64 {
        let square = |k: usize| self.moved[k].norm_squared() / self.squares[k];
        let most = square(0).max(square(1)).max(square(2));
        (most * self.moved_unit * self.moved_unit).min(f64::MAX)
    }

    /// The least positive gain at which [`LEAST_AREA`] is left of it or an edge has the `stretch`;
    /// `limit` if that is less.
    pub fn safe_gain(&self, stretch: f64, limit: f64) -> f64 {
        let limit = self.folding_gain(limit);
        let limit = self.stretching_gain(0, stretch, limit);
        let limit = self.stretching_gain(1, stretch, limit);
        self.stretching_gain(2, stretch, limit)
    }

    /// The same for each corner: the gain of an edge concerns its two ends.
    pub fn safe_gains(&self, stretch: f64, limit: f64) -> [f64; 3] {
        let limit = self.folding_gain(limit);
        let [a, b, c] = [0, 1, 2].map(|edge| self.stretching_gain(edge, stretch, limit));
        [a.min(c), a.min(b), b.min(c)]
    }

    /// The first positive root of n·N(g) = [`LEAST_AREA`] n², where N(g) is the normal n at gain g.
    fn folding_gain(&self, limit: f64) -> f64 {
        let [a, _, b] = &self.edges;
        let [u, _, v] = &self.changes;
        let constant = (1.0 - LEAST_AREA) * self.normal.norm_squared();
        let linear = self.normal.dot(&(b.cross(u) + v.cross(a)));
        let square = self.normal.dot(&v.cross(u));
        if linear >= 0.0 && square >= 0.0 {
            return limit;
        }
        let most = limit / self.gain;
        if constant + most * (linear.min(0.0) + most * square.min(0.0)) > 0.0 {
            return limit;
        }
        let discriminant = linear * linear - 4.0 * constant * square;
        if discriminant < 0.0 {
            return limit;
        }
        let root = match linear < 0.0 {
            true => 2.0 * constant / (discriminant.sqrt() - linear),
            false => -0.5 * (linear + discriminant.sqrt()) / square,
        };
        limit.min(root * self.gain)
    }

    /// The positive root of |e + g d|² = stretch² |e|².
    fn stretching_gain(&self, edge: usize, stretch: f64, limit: f64) -> f64 {
        let (edge, change, square) = (&self.edges[edge], &self.changes[edge], self.squares[edge]);
        let room = stretch * stretch * square - edge.norm_squared();
        let (along, size) = (edge.dot(change), change.norm_squared());
        let most = limit / self.gain;
        if size == 0.0 || most * (2.0 * along + most * size) < room {
            return limit;
        }
        let middle = (along * along + size * room).sqrt();
        let root = match along < 0.0 {
            true => (middle - along) / size,
            false => room / (middle + along),
        };
        limit.min(root * self.gain)
    }
}

/// From corner 0 to 1, from 1 to 2, and from 2 to 0.
#[inline]
fn differences([a, b, c]: [&[f64; 3]; 3]) -> [Vector; 3] {
    let between = |from: &[f64; 3], to: &[f64; 3]| {
        Vector::new(to[0] - from[0], to[1] - from[1], to[2] - from[2])
    };
    [between(a, b), between(b, c), between(c, a)]
}

#[inline]
fn squares([a, b, c]: &[Vector; 3]) -> [f64; 3] {
    [a.norm_squared(), b.norm_squared(), c.norm_squared()]
}

fn largest_square(vectors: &[Vector; 3]) -> f64 {
    let [a, b, c] = squares(vectors);
    a.max(b).max(c)
}

/// The normal of a face with these edges, twice its area long.
fn normal_of(edges: &[Vector; 3]) -> Vector {
    edges[2].cross(&edges[0])
}
