//! What balls have room in.

use std::f64::consts::PI;

use rstar::RTree;

use crate::thickness::ball::Ball;
use crate::thickness::samples::{Obstacle, obstacles};
use crate::thickness::scaled::{Scaled, along, difference, dot, square_distance};
use crate::thickness::search::Region;
use crate::thickness::triangle::Triangle;

/// The radius that is tried first, as the nearest points to a far center are slow to find; and by how
/// much the next is larger.
const USUAL: f64 = 0.04;
const LARGER: f64 = 3.0;
/// How far from the center of a ball the point is at most that it belongs to, in radii: the skin may be
/// rough.
const ROUGH: f64 = 1.25;
/// Steps of the way to the largest ball near by, in radii: the first and the least; and by how much of
/// a step a ball grows at least.
const STEPS: (f64, f64) = (0.9, 0.1);
const GAIN: f64 = 0.2;
/// The length of the mean of directions that cancel one another.
const CANCELLED: f64 = 1e-3;
/// From so many distances between points on they are dense.
const DENSE: f64 = 3.0;

/// What is around the balls of a part of the surface.
pub(super) struct Space {
    obstacles: RTree<Obstacle>,
    triangles: RTree<Triangle>,
    /// The radius of the ball with the area of the part: no closed surface holds a larger one.
    largest: f64,
}

impl Space {
    pub fn new(shape: &Scaled, part: &[u32]) -> Self {
        let triangles = part.iter().map(|face| Triangle(shape.corners(*face)));
        let (obstacles, triangles) = rayon::join(
            || RTree::bulk_load(obstacles(shape, part)),
            || RTree::bulk_load(triangles.collect()),
        );
        Self {
            obstacles,
            triangles,
            largest: (shape.area_of(part) / (4.0 * PI)).sqrt(),
        }
    }

    /// The largest ball that touches the surface at `point`, has its center in the given unit
    /// `direction` from there, and no point of the surface inside.
    pub fn touching(&self, vertex: u32, point: [f64; 3], direction: [f64; 3]) -> Ball {
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
        ball.shrink(direction, &self.obstacles, |obstacle| {
            distance = obstacle.data
        });
        let is_opposite = ball.cosine < 0.0;
        if ball.radius < distance * if is_opposite { 2.0 } else { 1.0 } {
            ball.shrink(direction, &self.triangles, |_| ());
        }
        ball
    }

    /// The largest ball that is found from this one on by moving away from what is around, while its point
    /// stays near: below bumps and folds of the skin that of the body.
    pub fn grown(&self, ball: Ball) -> Ball {
        let mut grown = ball;
        let mut known = vec![Known::at(ball.point), Known::at(ball.contact)];
        let mut step = STEPS.0;
        while step >= STEPS.1 {
            let Some(away) = away(&grown, &known, step) else {
                break;
            };
            let center = along(grown.center, step * grown.radius, away);
            let apart = square_distance(ball.point, center).sqrt();
            let least = (grown.radius * (1.0 + GAIN * step)).max(apart / ROUGH);
            if let Some(radius) = self.room(center, least, &mut known) {
                (grown.center, grown.radius) = (center, radius);
            } else {
                step *= 0.5;
            }
        }
        grown
    }

    /// The radius of the largest ball about a center that has nothing inside, if it is `least` and more.
    /// What is `known` spares most of the search, which adds what is nearer.
    fn room(&self, center: [f64; 3], least: f64, known: &mut Vec<Known>) -> Option<f64> {
        let square = |known: &Known| square_distance(known.point, center);
        let by_distance = |a: &&Known, b: &&Known| square(a).total_cmp(&square(b));
        let mut nearest = *known.iter().min_by(by_distance)?;
        let mut radius = square(&nearest).sqrt();
        let region = Region::new(center, radius.min(self.largest));
        let mut points = region.within(&self.obstacles);
        while radius >= least
            && let Some(obstacle) = points.next()
        {
            nearest = Known {
                point: *obstacle.geom(),
                spacing: obstacle.data,
            };
            radius = square(&nearest).sqrt();
            region.shrink(center, radius);
        }
        let mut triangles = region.within(&self.triangles);
        let is_rough = radius <= DENSE * nearest.spacing;
        while is_rough
            && radius >= least
            && let Some(triangle) = triangles.next()
        {
            nearest = Known::at(triangle.nearest(center));
            radius = square(&nearest).sqrt();
            region.shrink(center, radius);
        }
        known.push(nearest);
        (least..self.largest).contains(&radius).then_some(radius)
    }
}

/// A point of the surface.
#[derive(Debug, Clone, Copy)]
struct Known {
    point: [f64; 3],
    /// How far from one of the points by which balls know the surface others are at most.
    spacing: f64,
}

impl Known {
    /// One that is not of those.
    fn at(point: [f64; 3]) -> Self {
        Self {
            point,
            spacing: f64::INFINITY,
        }
    }
}

/// The direction from what is known to be around a ball to its center. What touches it counts most, and
/// what is `step` radii beyond no more. `None` between opposite sides.
fn away(ball: &Ball, known: &[Known], step: f64) -> Option<[f64; 3]> {
    let mut sum = [0.0; 3];
    for known in known {
        let across = difference(ball.center, known.point);
        let distance = dot(across, across).sqrt();
        let beyond = (distance / ball.radius - 1.0).max(0.0);
        if distance > 0.0 && beyond < step {
            sum = along(sum, (1.0 - beyond / step) / distance, across);
        }
    }
    let length = dot(sum, sum).sqrt();
    (length > CANCELLED).then(|| sum.map(|x| x / length))
}
