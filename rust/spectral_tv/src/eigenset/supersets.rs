//! Supersets of a set, as candidates for a smaller perimeter.

use std::collections::HashSet;

use crate::discretization::Discretization;
use crate::eigenset::diffusion::Diffusion;
use crate::error::Result;
use crate::flow::Trajectory;
use crate::monitor::Stage;

/// Numbers of radii of diffusion, from two edges to half the surface's size.
const RADII: usize = 6;
/// Levels of a diffused indicator: they fill what is hollow.
const LEVELS: [f64; 3] = [0.5, 0.35, 0.2];
/// Shares of the outside that a level set takes in: they grow the set evenly.
const SHARES: usize = 8;
/// Levels of a state of the flow, from the outside's least value to the set's mean.
const FLOW_LEVELS: [f64; 3] = [0.25, 0.5, 0.75];

/// Level sets of the diffused indicator of `set` (V), at several radii, and of the states of its
/// flow, each together with the set, within `surface` (V); no set twice.
///
/// The flow itself moves towards what a set with too long a boundary is a part of.
pub(super) fn supersets(
    operators: &Discretization,
    set: &[bool],
    surface: &[bool],
    flow: &Trajectory,
    edge: f64,
    stage: Stage,
) -> Result<Vec<Vec<bool>>> {
    let masses = operators.masses();
    let mut found = Supersets::new(set, surface, masses);
    let (least, most) = (2.0 * edge, 0.5 * operators.area().sqrt());
    for k in 0..RADII {
        stage.report(k as f64 / RADII as f64)?;
        let radius = least * (most / least).max(1.0).powf(k as f64 / (RADII - 1) as f64);
        let values = Diffusion::new(operators, radius, stage)?.apply(set);
        for level in LEVELS {
            found.add(&values, level);
        }
        let mut outside = found.outside();
        outside.sort_unstable_by(|&p, &q| values[q].total_cmp(&values[p]));
        let whole: f64 = outside.iter().map(|&v| masses[v]).sum();
        for share in (1..=SHARES).map(|k| k as f64 / (SHARES + 1) as f64) {
            let mut area = 0.0;
            let last = outside.iter().find(|&&v| {
                area += masses[v];
                area >= share * whole
            });
            if let Some(&last) = last {
                found.add(&values, values[last]);
            }
        }
    }
    for state in flow.states().skip(2).step_by(2) {
        let values = state.row(0).to_vec();
        let outside = found.outside();
        let least = outside.iter().map(|&v| values[v]).fold(f64::MAX, f64::min);
        let mean = found.mean(&values);
        for level in FLOW_LEVELS {
            found.add(&values, least + level * (mean - least));
        }
    }
    stage.report(1.0)?;
    Ok(found.sets)
}

/// Collects supersets of a set.
struct Supersets<'a> {
    set: &'a [bool],
    surface: &'a [bool],
    masses: &'a [f64],
    sets: Vec<Vec<bool>>,
    seen: HashSet<(usize, u64)>,
}

impl<'a> Supersets<'a> {
    fn new(set: &'a [bool], surface: &'a [bool], masses: &'a [f64]) -> Self {
        let mut this = Self {
            set,
            surface,
            masses,
            sets: Vec::new(),
            seen: HashSet::new(),
        };
        // The set itself and the whole surface are not asked for.
        this.is_new(set);
        this.is_new(surface);
        this
    }

    /// Adds the set together with where `values` reach `level`.
    fn add(&mut self, values: &[f64], level: f64) {
        let superset: Vec<bool> = (0..self.set.len())
            .map(|v| self.set[v] || (self.surface[v] && values[v] >= level))
            .collect();
        if self.is_new(&superset) {
            self.sets.push(superset);
        }
    }

    fn is_new(&mut self, set: &[bool]) -> bool {
        let area: f64 = members(set).map(|v| self.masses[v]).sum();
        self.seen.insert((members(set).count(), area.to_bits()))
    }

    fn outside(&self) -> Vec<usize> {
        members(self.surface).filter(|&v| !self.set[v]).collect()
    }

    fn mean(&self, values: &[f64]) -> f64 {
        let weighted = |value: &dyn Fn(usize) -> f64| -> f64 {
            members(self.set).map(|v| self.masses[v] * value(v)).sum()
        };
        weighted(&|v| values[v]) / weighted(&|_| 1.0)
    }
}

/// Indices of the members of a set.
pub(super) fn members(set: &[bool]) -> impl Iterator<Item = usize> {
    (0..set.len()).filter(|&v| set[v])
}
