//! The balls that touch a surface from inside.

use std::f64::consts::PI;

use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;

use crate::error::Result;
use crate::monitor::Stage;
use crate::thickness::outward::Outward;
use crate::thickness::samples::{Obstacle, Sample, obstacles, samples};
use crate::thickness::scaled::{Scaled, along, difference, dot, square_distance};
use crate::thickness::triangle::Triangle;

/// Times that a ball shrinks at most.
const SHRINKINGS: usize = 40;
/// Relative change of a radius that ends it.
const ROUNDING: f64 = 1e-6;
/// The radius that is tried first, as the nearest points to a far center are slow to find; and by how
/// much the next is larger.
const USUAL: f64 = 0.04;
const LARGER: f64 = 3.0;
/// What is nearer to a point than this is taken for itself.
const NEAREST: f64 = 1e-7;
/// The cosine between the points of contact from which on a ball lies between opposite sides.
const OPPOSITE: f64 = -0.86;
/// How far the two layers of a shell go on side by side, in thicknesses, to count as one.
const WIDE: f64 = 20.0;
/// The share of both its layers that is found within that distance.
const WHOLE: f64 = 0.7;

/// How far from the center of a ball the point is at most that it belongs to, in radii: the skin may be
/// rough.
const ROUGH: f64 = 1.25;
/// The cosine between the normal there and its direction from the center, at least.
const FACING: f64 = 0.5;
/// Steps of the way to the largest ball near by, in radii: the first and the least.
const STEPS: (f64, f64) = (0.9, 0.1);
/// From so many distances between points on they are dense.
const DENSE: f64 = 3.0;
/// How many times thicker a shell is elsewhere at most.
const ALIKE: f64 = 2.0;

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
    point: [f64; 3],
    /// Where it touches the surface besides; `point` where it does not.
    contact: [f64; 3],
    /// The cosine between both, seen from the center; 1 where there is one.
    cosine: f64,
}

/// The balls of each connected part.
pub(super) struct Balls {
    pub parts: Vec<Vec<Ball>>,
}

impl Balls {
    /// Inscribes a ball at every sample.
    pub fn inscribed(shape: &Scaled, outward: &Outward, stage: Stage) -> Result<Self> {
        let parts = shape.parts.par_iter();
        let parts = parts.map(|part| of_part(shape, outward, part, stage));
        Ok(Self {
            parts: parts.collect::<Result<_>>()?,
        })
    }
}

fn of_part(shape: &Scaled, outward: &Outward, part: &[u32], stage: Stage) -> Result<Vec<Ball>> {
    stage.check()?;
    let area = shape.area_of(part);
    let triangles = part.iter().map(|face| Triangle(shape.corners(*face)));
    let (obstacles, triangles) = rayon::join(
        || RTree::bulk_load(obstacles(shape, part)),
        || RTree::bulk_load(triangles.collect()),
    );
    let space = Space {
        obstacles,
        triangles,
        largest: (area / (4.0 * PI)).sqrt(),
    };
    stage.check()?;
    let (samples, spread) = samples(shape, part);
    let of_sample = |sample: &Sample| {
        stage.check()?;
        let inward = inverse(outward.normal(shape, sample.face));
        Ok(space.touching(sample.vertex, sample.point, inward))
    };
    let inside: Vec<Ball> = samples.par_iter().map(of_sample).collect::<Result<_>>()?;
    let evenly = inside[..spread].iter();
    let points = evenly.map(|ball| GeomWithData::new(ball.point, ball.radius));
    let layers = Layers {
        samples: RTree::bulk_load(points.collect()),
        area: area / spread as f64,
    };
    let is_shell = inside.par_iter().map(|ball| layers.are_shell(ball));
    let is_shell: Vec<bool> = is_shell.collect();
    // The rim of a shell is as thin as the shell, which tells nothing.
    let is_all_shell = 2 * is_shell.iter().filter(|is_shell| **is_shell).count() > samples.len();
    let finished = |index: usize| {
        let (sample, ball) = (samples[index], inside[index]);
        if !is_shell[index] && !outward.is_sheet[sample.face as usize] {
            return space.grown(ball);
        }
        let normal = outward.normal(shape, sample.face);
        let outside = space.touching(sample.vertex, sample.point, normal);
        let found = if is_shell[index] {
            // Either layer may be the outer one.
            let beyond = space.touching(sample.vertex, ball.contact, inverse(normal));
            beyond.smaller(outside)
        } else {
            ball.smaller(outside)
        };
        Ball {
            is_either_side: true,
            ..found
        }
    };
    let used = (0..samples.len()).into_par_iter();
    let used = used.filter(|index| is_shell[*index] || !is_all_shell);
    stage.pass(|| used.map(finished).collect())
}

/// What balls have room in.
struct Space {
    obstacles: RTree<Obstacle>,
    triangles: RTree<Triangle>,
    /// The radius of the ball with the area of the part: no closed surface holds a larger one.
    largest: f64,
}

impl Space {
    /// The largest ball that touches the surface at `point`, has its center in the given unit
    /// `direction` from there, and no point of the surface inside.
    fn touching(&self, vertex: u32, point: [f64; 3], direction: [f64; 3]) -> Ball {
        let mut size = self.largest.min(USUAL);
        let mut ball = self.within(vertex, point, direction, size);
        while ball.radius == size && size < self.largest {
            size = self.largest.min(LARGER * size);
            ball = self.within(vertex, point, direction, size);
        }
        ball
    }

    /// The same of at most the radius `size`.
    fn within(&self, vertex: u32, point: [f64; 3], direction: [f64; 3], size: f64) -> Ball {
        let mut ball = Ball {
            center: along(point, size, direction),
            radius: size,
            is_either_side: false,
            vertex,
            point,
            contact: point,
            cosine: 1.0,
        };
        // Points are found faster than triangles, and tell enough of where they are dense.
        let mut distance = 0.0;
        ball.shrink(direction, |center| {
            let nearest = self.obstacles.nearest_neighbor(&center)?;
            distance = nearest.data;
            Some(*nearest.geom())
        });
        let is_opposite = ball.cosine < 0.0;
        if ball.radius
            < if is_opposite {
                2.0 * distance
            } else {
                distance
            }
        {
            ball.shrink(direction, |center| {
                let nearest = self.triangles.nearest_neighbor(&center)?;
                Some(nearest.nearest(center))
            });
        }
        ball
    }

    /// The largest ball that is found from this one on by moving away from what is nearest, while its
    /// point stays near and faces it: below bumps and folds of the skin that of the body.
    fn grown(&self, ball: Ball) -> Ball {
        let normal = difference(ball.point, ball.center).map(|x| x / ball.radius);
        let mut grown = ball;
        let mut step = STEPS.0;
        let Some(mut nearest) = self.nearest(grown.center) else {
            return ball;
        };
        while step >= STEPS.1 {
            let away = difference(grown.center, nearest);
            let center = along(grown.center, step, away);
            let Some(next) = self.nearest(center) else {
                break;
            };
            let radius = square_distance(center, next).sqrt();
            let outward = difference(ball.point, center);
            let apart = dot(outward, outward).sqrt();
            let is_there = apart <= ROUGH * radius && dot(outward, normal) > FACING * apart;
            let is_larger = radius > grown.radius * (1.0 + 0.1 * step);
            if is_larger && radius < self.largest && is_there {
                (grown.center, grown.radius, nearest) = (center, radius, next);
            } else {
                step *= 0.5;
            }
        }
        grown
    }

    /// What is nearest to a center: a point where these are dense, or else that of a triangle.
    fn nearest(&self, center: [f64; 3]) -> Option<[f64; 3]> {
        let point = self.obstacles.nearest_neighbor(&center)?;
        let far = DENSE * point.data;
        if square_distance(*point.geom(), center) > far * far {
            return Some(*point.geom());
        }
        Some(self.triangles.nearest_neighbor(&center)?.nearest(center))
    }
}

impl Ball {
    /// Whether it lies between opposite sides.
    fn is_between(&self) -> bool {
        self.cosine <= OPPOSITE
    }

    fn smaller(self, other: Self) -> Self {
        if other.radius < self.radius {
            other
        } else {
            self
        }
    }

    /// Shrinks until what is `nearest` to the center is not inside.
    fn shrink(
        &mut self,
        direction: [f64; 3],
        mut nearest: impl FnMut([f64; 3]) -> Option<[f64; 3]>,
    ) {
        for _ in 0..SHRINKINGS {
            let Some(contact) = nearest(self.center) else {
                break;
            };
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
        }
    }
}

/// Samples that are spread as the area is, to tell how much of the surface is near.
struct Layers {
    /// With the radii of their balls.
    samples: RTree<GeomWithData<[f64; 3], f64>>,
    /// Of each.
    area: f64,
}

impl Layers {
    /// Whether a ball lies between two layers that go on side by side for much more than its size.
    fn are_shell(&self, ball: &Ball) -> bool {
        let reach = (WIDE * ball.radius).max(3.0 * self.area.sqrt());
        let needed = (WHOLE * 2.0 * PI * reach * reach / self.area).ceil() as usize;
        if !ball.is_between() || needed > self.samples.size() {
            return false;
        }
        let near = self
            .samples
            .locate_within_distance(ball.center, reach * reach)
            .filter(|sample| sample.data < ALIKE * ball.radius);
        near.take(needed).count() == needed
    }
}

fn inverse(direction: [f64; 3]) -> [f64; 3] {
    direction.map(|x| -x)
}
