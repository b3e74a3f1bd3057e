//! The largest ball that reaches each vertex.

use crate::error::Result;
use crate::monitor::Stage;
use crate::thickness::ball::{Ball, Balls};
use crate::thickness::incidence::Incidence;
use crate::thickness::scaled::{Scaled, square_distance};

/// How far a ball reaches, in its radii from its center.
const REACH: f64 = 1.4;
/// A ball is passed over where one reaches its vertex that is larger by this.
const LARGER: f64 = 1.5;
/// The same for one of any larger size, if its center is within this share of its radius.
const SAME: f64 = 0.3;

/// The radius (V) of the largest ball that reaches each vertex along the surface from the ball's own
/// vertex; 0 for vertices that none reaches.
pub(super) fn reached(
    shape: &Scaled,
    incidence: &Incidence,
    balls: &Balls,
    stage: Stage,
) -> Result<Vec<f64>> {
    let mut reached = Reached {
        radii: vec![0.0; shape.points.len()],
        last: vec![0; shape.points.len()],
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
            let adds_little = || found >= LARGER * ball.radius || spread.iter().any(is_same);
            if found < ball.radius || !adds_little() {
                reached.spread(shape, incidence, ball);
                spread.push(ball);
            }
        }
    }
    Ok(reached.radii)
}

/// What balls have reached so far.
struct Reached {
    radii: Vec<f64>,
    /// Which ball came by a vertex last, by its number.
    last: Vec<u32>,
    count: u32,
}

impl Reached {
    /// Has a ball reach what it reaches.
    fn spread(&mut self, shape: &Scaled, incidence: &Incidence, ball: &Ball) {
        self.count += 1;
        let reach = (REACH * ball.radius).powi(2);
        self.last[ball.vertex as usize] = self.count;
        let mut front = vec![ball.vertex];
        while let Some(vertex) = front.pop() {
            let radius = &mut self.radii[vertex as usize];
            *radius = radius.max(ball.radius);
            for neighbour in incidence.around(shape, vertex) {
                let is_new = self.last[neighbour as usize] != self.count;
                let point = shape.points[neighbour as usize];
                if is_new && square_distance(point, ball.center) <= reach {
                    self.last[neighbour as usize] = self.count;
                    front.push(neighbour);
                }
            }
        }
    }
}
