//! The largest ball that reaches each vertex.

use crate::error::Result;
use crate::monitor::Stage;
use crate::parallel;
use crate::thickness::ball::Ball;
use crate::thickness::incidence::Incidence;
use crate::thickness::inscribed::Balls;
use crate::thickness::outward::Outward;
use crate::thickness::scaled::{Scaled, difference, dot, square_distance};

/// How far a ball reaches, in its radii from its center: beyond the corners of a cube.
const REACH: f64 = 1.8;
/// A ball reaches the triangles that face away from its center: the cosine between their normal and
/// the direction from there is over this, as at the corners of a cube. The sides of what stands out
/// do not.
const FACING: f64 = 0.55;
/// How far a ball goes on over other triangles, in its radii, to those beyond, as over the walls of a
/// groove.
const ASIDE: f64 = 0.3;
/// A ball is passed over where one reaches its vertex that is larger by this.
const LARGER: f64 = 1.5;
/// The same for one of any larger size, if its center is within this share of its radius.
const SAME: f64 = 0.3;

/// The radius (V) of the largest ball that reaches each vertex along the surface from the ball's own
/// vertex; 0 for vertices that none reaches.
pub(super) fn reached(
    shape: &Scaled,
    incidence: &Incidence,
    outward: &Outward,
    balls: &Balls,
    stage: Stage,
) -> Result<Vec<f64>> {
    let side = |face: usize| {
        let corners = shape.corners(face as u32);
        let middle = std::array::from_fn(|axis| corners.iter().map(|p| p[axis]).sum::<f64>() / 3.0);
        [middle, outward.normal(shape, face as u32)]
    };
    let mut reached = Reached {
        shape,
        incidence,
        sides: stage.pass(|| parallel::values(shape.triangles.len(), side))?,
        radii: vec![0.0; shape.points.len()],
        aside: vec![(0, 0.0); shape.points.len()],
        last: vec![0; shape.triangles.len()],
        count: 0,
    };
    for part in &balls.parts {
        let mut order: Vec<&Ball> = part.iter().collect();
        order.sort_by(|a, b| b.radius.total_cmp(&a.radius));
        let mut spread: Vec<&Ball> = Vec::new();
        for ball in order {
            stage.check()?;
            let found = reached.radii[ball.vertex as usize];
            let is_same = |larger: &&Ball| {
                let distance = SAME * larger.radius;
                square_distance(ball.center, larger.center) < distance * distance
            };
            let adds_much = || found < LARGER * ball.radius && !spread.iter().any(is_same);
            if found < ball.radius || adds_much() {
                reached.spread(ball);
                spread.push(ball);
            }
        }
    }
    Ok(reached.radii)
}

/// What balls have reached so far.
struct Reached<'a> {
    shape: &'a Scaled,
    incidence: &'a Incidence,
    /// The middles of the triangles, and their normals, outward, F.
    sides: Vec<[[f64; 3]; 2]>,
    radii: Vec<f64>,
    /// Which ball came by a vertex last, by its number, and how far it had gone on over triangles that
    /// do not face it, V.
    aside: Vec<(u32, f64)>,
    /// Which ball reached a triangle last, by its number, F.
    last: Vec<u32>,
    count: u32,
}

impl Reached<'_> {
    /// Has a ball reach what it reaches, and its own vertex.
    fn spread(&mut self, ball: &Ball) {
        self.count += 1;
        let farthest = (REACH * ball.radius).powi(2);
        self.claim(ball.vertex, ball);
        self.aside[ball.vertex as usize] = (self.count, 0.0);
        let mut front = vec![ball.vertex];
        while let Some(vertex) = front.pop() {
            let (_, before) = self.aside[vertex as usize];
            for &face in self.incidence.faces(vertex) {
                if self.last[face as usize] == self.count {
                    continue;
                }
                let is_facing = self.is_facing(face, ball);
                if is_facing {
                    self.last[face as usize] = self.count;
                }
                for corner in self.shape.triangles[face as usize] {
                    let known = self.aside[corner as usize];
                    if known == (self.count, 0.0) {
                        continue;
                    }
                    let point = self.shape.points[corner as usize];
                    if square_distance(point, ball.center) > farthest {
                        continue;
                    }
                    let aside = if is_facing {
                        self.claim(corner, ball);
                        0.0
                    } else {
                        before + self.shape.distance(vertex, corner)
                    };
                    let is_nearer = known.0 != self.count || aside < known.1;
                    if is_nearer && aside <= ASIDE * ball.radius {
                        self.aside[corner as usize] = (self.count, aside);
                        front.push(corner);
                    }
                }
            }
        }
    }

    fn claim(&mut self, vertex: u32, ball: &Ball) {
        let radius = &mut self.radii[vertex as usize];
        *radius = radius.max(ball.radius);
    }

    /// Whether a triangle faces away from the center of a ball.
    fn is_facing(&self, face: u32, ball: &Ball) -> bool {
        let [middle, normal] = self.sides[face as usize];
        let across = difference(middle, ball.center);
        let depth = dot(normal, across);
        let is_outer = depth > 0.0 || ball.is_either_side;
        is_outer && depth * depth > FACING * FACING * dot(across, across)
    }
}
