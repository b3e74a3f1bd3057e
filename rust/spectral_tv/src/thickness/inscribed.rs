//! The balls that touch a surface from inside, all over it.

use std::f64::consts::PI;

use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;

use crate::error::Result;
use crate::monitor::Stage;
use crate::thickness::ball::Ball;
use crate::thickness::outward::Outward;
use crate::thickness::samples::{Sample, samples};
use crate::thickness::scaled::{Scaled, inverse};
use crate::thickness::space::Space;

/// How far the two layers of a shell go on side by side, in thicknesses, to count as one.
const WIDE: f64 = 20.0;
/// The share of both its layers that is found within that distance.
const WHOLE: f64 = 0.7;
/// How many times thicker a shell is elsewhere at most.
const ALIKE: f64 = 2.0;

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
    let space = Space::new(shape, part);
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
