//! The largest ball that reaches each vertex.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rayon::prelude::*;

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
/// Threads that have balls go along the surface at the same time, at most.
const WALKS: usize = 4;
/// Balls that are chosen at once, at most: none of them is passed over as another has its vertex.
const AT_A_TIME: usize = 64;
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
    let surface = Surface {
        shape,
        incidence,
        sides: stage.pass(|| parallel::values(shape.triangles.len(), side))?,
    };
    let mut radii: Vec<f64> = vec![0.0; shape.points.len()];
    let mut walks: Vec<Walk> = (0..WALKS).map(|_| Walk::on(&surface)).collect();
    for part in &balls.parts {
        let mut order: Vec<&Ball> = part.iter().collect();
        order.sort_by(|a, b| b.radius.total_cmp(&a.radius));
        let mut spread: Vec<&Ball> = Vec::new();
        let mut rest = &order[..];
        while !rest.is_empty() {
            stage.check()?;
            let first = spread.len();
            let count = first.clamp(WALKS, AT_A_TIME).min(rest.len());
            let (balls, others) = rest.split_at(count);
            rest = others;
            for &ball in balls {
                let found = radii[ball.vertex as usize];
                let is_same = |larger: &&Ball| {
                    let distance = SAME * larger.radius;
                    square_distance(ball.center, larger.center) < distance * distance
                };
                let adds_much = || found < LARGER * ball.radius && !spread.iter().any(is_same);
                if found < ball.radius || adds_much() {
                    spread.push(ball);
                }
            }
            let claims = walks.par_iter_mut().enumerate().map(|(place, walk)| {
                let own = spread[first..].iter().skip(place).step_by(WALKS);
                own.map(|ball| (ball.radius, walk.claimed(ball)))
                    .collect::<Vec<_>>()
            });
            for (radius, claimed) in claims.collect::<Vec<_>>().into_iter().flatten() {
                for vertex in claimed {
                    let known = &mut radii[vertex as usize];
                    *known = known.max(radius);
                }
            }
        }
    }
    Ok(radii)
}

/// What balls go along.
struct Surface<'a> {
    shape: &'a Scaled,
    incidence: &'a Incidence,
    /// The middles of the triangles, and their normals, outward, F.
    sides: Vec<[[f64; 3]; 2]>,
}

/// The ways of balls along a surface, one after the other.
struct Walk<'a> {
    surface: &'a Surface<'a>,
    /// Which ball came by a vertex last, by its number, and how far it had gone on over triangles that
    /// do not face it, V.
    aside: Vec<(u32, f64)>,
    /// Which ball reached a triangle last, by its number, F.
    last: Vec<u32>,
    count: u32,
}

impl<'a> Walk<'a> {
    fn on(surface: &'a Surface<'a>) -> Self {
        Self {
            aside: vec![(0, 0.0); surface.shape.points.len()],
            last: vec![0; surface.shape.triangles.len()],
            count: 0,
            surface,
        }
    }

    /// The vertices that a ball reaches, its own among them; some more than once.
    fn claimed(&mut self, ball: &Ball) -> Vec<u32> {
        let Surface {
            shape, incidence, ..
        } = self.surface;
        self.count += 1;
        let farthest = (REACH * ball.radius).powi(2);
        let mut claimed = vec![ball.vertex];
        self.aside[ball.vertex as usize] = (self.count, 0.0);
        // Those that nothing lies aside of, then the nearest ones first, so that each is left once.
        let (mut facing, mut others) = (vec![ball.vertex], BinaryHeap::new());
        let nearest = |Reverse((bits, vertex))| (f64::from_bits(bits), vertex);
        while let Some((before, vertex)) = facing
            .pop()
            .map(|vertex| (0.0, vertex))
            .or_else(|| others.pop().map(nearest))
        {
            if before > self.aside[vertex as usize].1 {
                continue; // left by a nearer way
            }
            for &face in incidence.faces(vertex) {
                if self.last[face as usize] == self.count {
                    continue;
                }
                let is_facing = self.surface.is_facing(face, ball);
                if is_facing {
                    self.last[face as usize] = self.count;
                }
                for corner in shape.triangles[face as usize] {
                    let known = self.aside[corner as usize];
                    if known == (self.count, 0.0) {
                        continue;
                    }
                    let point = shape.points[corner as usize];
                    if square_distance(point, ball.center) > farthest {
                        continue;
                    }
                    let aside = if is_facing {
                        claimed.push(corner);
                        0.0
                    } else {
                        before + shape.distance(vertex, corner)
                    };
                    let is_nearer = known.0 != self.count || aside < known.1;
                    if is_nearer && aside <= ASIDE * ball.radius {
                        self.aside[corner as usize] = (self.count, aside);
                        match aside == 0.0 {
                            true => facing.push(corner),
                            // The bits of numbers from 0 on are ordered as they are.
                            false => others.push(Reverse((aside.to_bits(), corner))),
                        }
                    }
                }
            }
        }
        claimed
    }
}

impl Surface<'_> {
    /// Whether a triangle faces away from the center of a ball.
    fn is_facing(&self, face: u32, ball: &Ball) -> bool {
        let [middle, normal] = self.sides[face as usize];
        let across = difference(middle, ball.center);
        let depth = dot(normal, across);
        let is_outer = depth > 0.0 || ball.is_either_side;
        is_outer && depth * depth > FACING * FACING * dot(across, across)
    }
}
