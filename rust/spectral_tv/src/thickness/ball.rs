//! The balls that touch a surface from inside.

use std::f64::consts::PI;

use rayon::prelude::*;
use rstar::RTree;

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

/// A ball that touches the surface at a sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ball {
    pub center: [f64; 3],
    pub radius: f64,
    /// The vertex next to the sample.
    pub vertex: u32,
    /// The cosine between the two points of contact, seen from the center; 1 where there is one.
    pub cosine: f64,
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
        let normal = outward.normal(shape, sample.face);
        Ok((space.touching(sample.point, inverse(normal)), normal))
    };
    let inside: Vec<(Touching, [f64; 3])> =
        samples.par_iter().map(of_sample).collect::<Result<_>>()?;
    let evenly = samples[..spread].iter().map(|sample| sample.point);
    let layers = Layers {
        samples: RTree::bulk_load(evenly.collect()),
        area: area / spread as f64,
    };
    let is_shell: Vec<bool> = inside
        .par_iter()
        .map(|(touching, _)| layers.are_shell(touching))
        .collect();
    // The rim of a shell is as thin as the shell, which tells nothing.
    let is_all_shell = 2 * is_shell.iter().filter(|is_shell| **is_shell).count() > samples.len();
    let finished = |index: usize| {
        let (sample, (touching, normal)) = (samples[index], inside[index]);
        let outside = || space.touching(sample.point, normal);
        let found = if is_shell[index] {
            // Either layer may be the outer one.
            space
                .touching(touching.contact, inverse(normal))
                .smaller(outside())
        } else if outward.is_sheet[sample.face as usize] {
            touching.smaller(outside())
        } else {
            touching
        };
        Ball {
            center: found.center,
            radius: found.radius,
            vertex: sample.vertex,
            cosine: found.cosine,
        }
    };
    let used = (0..samples.len()).into_par_iter();
    let used = used.filter(|index| is_shell[*index] || !is_all_shell);
    stage.pass(|| used.map(finished).collect())
}

/// A ball and where it touches the surface besides the point that it was put at.
#[derive(Debug, Clone, Copy)]
struct Touching {
    center: [f64; 3],
    radius: f64,
    contact: [f64; 3],
    cosine: f64,
}

impl Touching {
    fn smaller(self, other: Self) -> Self {
        if other.radius < self.radius {
            other
        } else {
            self
        }
    }
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
    fn touching(&self, point: [f64; 3], direction: [f64; 3]) -> Touching {
        let mut size = self.largest.min(USUAL);
        let mut ball = self.within(point, direction, size);
        while ball.radius == size && size < self.largest {
            size = self.largest.min(LARGER * size);
            ball = self.within(point, direction, size);
        }
        ball
    }

    /// The same of at most the radius `size`.
    fn within(&self, point: [f64; 3], direction: [f64; 3], size: f64) -> Touching {
        let mut ball = Touching {
            center: along(point, size, direction),
            radius: size,
            contact: point,
            cosine: 1.0,
        };
        // Points are found faster than triangles, and tell enough of where they are dense.
        let mut distance = 0.0;
        ball.shrink(point, direction, |center| {
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
            ball.shrink(point, direction, |center| {
                let nearest = self.triangles.nearest_neighbor(&center)?;
                Some(nearest.nearest(center))
            });
        }
        ball
    }
}

impl Touching {
    /// Shrinks until what is `nearest` to the center is not inside.
    fn shrink(
        &mut self,
        point: [f64; 3],
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
            let across = difference(contact, point);
            let depth = dot(across, direction);
            let radius = dot(across, across) / (2.0 * depth);
            let shrinks = radius > 0.0 && radius < self.radius * (1.0 - ROUNDING);
            let is_apart = dot(across, across) > NEAREST * NEAREST;
            if depth <= 0.0 || !shrinks || !is_apart {
                break;
            }
            let center = along(point, radius, direction);
            let cosine = dot(difference(contact, center), inverse(direction)) / radius;
            *self = Self {
                center,
                radius,
                contact,
                cosine,
            };
        }
    }
}

/// Samples that are spread as the area is, to tell how much of the surface is near.
struct Layers {
    samples: RTree<[f64; 3]>,
    /// Of each.
    area: f64,
}

impl Layers {
    /// Whether a ball lies between two layers that go on side by side for much more than its size.
    fn are_shell(&self, ball: &Touching) -> bool {
        let reach = (WIDE * ball.radius).max(3.0 * self.area.sqrt());
        let needed = (WHOLE * 2.0 * PI * reach * reach / self.area).ceil() as usize;
        if ball.cosine > OPPOSITE || needed > self.samples.size() {
            return false;
        }
        let near = self
            .samples
            .locate_within_distance(ball.center, reach * reach);
        near.take(needed).count() == needed
    }
}

fn inverse(direction: [f64; 3]) -> [f64; 3] {
    direction.map(|x| -x)
}
