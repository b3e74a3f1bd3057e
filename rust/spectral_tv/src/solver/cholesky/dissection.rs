//! Orders of elimination by nested dissection (George 1973): first both sides of a separator, which
//! do not depend on each other, and then the separator.

use sprs::CsMatI;

use crate::error::Result;
use crate::graph::Graph;
use crate::monitor::Stage;
use crate::solver::cholesky::part::{Part, Side};
use crate::solver::cholesky::separator::separate;

/// Share of a part's vertices that a cut leaves on either side, and, on both sides of it, of those
/// among which a separator is looked for.
const LEAST_SHARE: f64 = 0.25;
const BAND: f64 = 0.15;

/// An order of elimination for matrices with the pattern of `lower`, in which parts of up to
/// `smallest` vertices are ordered by approximate minimum degree.
///
/// # Errors
/// [`Error::Solver`] if the index range does not suffice, or [`Error::Cancelled`].
pub(super) fn order(lower: &CsMatI<f64, u32>, smallest: usize, stage: Stage) -> Result<Vec<u32>> {
    let whole = Part::whole(Graph::new(lower, stage)?);
    let mut order = vec![0; lower.cols()];
    dissect(&whole, smallest, &mut order, stage)?;
    Ok(order)
}

fn dissect(part: &Part, smallest: usize, order: &mut [u32], stage: Stage) -> Result<()> {
    stage.check()?;
    if part.len() <= smallest {
        return part.by_degree(order);
    }
    let sides = bisect(part, stage)?;
    let parts = [Side::First, Side::Second].map(|side| part.restricted_to(side, &sides));
    let [first, second] = &parts;
    if first.len().min(second.len()) == 0 {
        return part.by_degree(order);
    }
    let (first_order, rest) = order.split_at_mut(first.len());
    let (second_order, separator) = rest.split_at_mut(second.len());
    let between = (0..part.len()).filter(|&vertex| sides[vertex] == Side::Between);
    for (place, vertex) in separator.iter_mut().zip(between) {
        *place = part.vertices[vertex];
    }
    let (one, other) = rayon::join(
        || dissect(first, smallest, first_order, stage),
        || dissect(second, smallest, second_order, stage),
    );
    one.and(other)
}

/// Two sides of a part, and what is between them.
fn bisect(part: &Part, stage: Stage) -> Result<Vec<Side>> {
    let size = part.len();
    let (_, order, ends) = part.rings(None);
    if ends.len() > 1 {
        // Between components, where both sides have most alike many vertices.
        let &end = ends
            .iter()
            .min_by_key(|end| end.abs_diff(size / 2))
            .expect("there are some");
        let mut sides = vec![Side::First; size];
        for &vertex in &order[end..] {
            sides[vertex as usize] = Side::Second;
        }
        return Ok(sides);
    }
    // Between two ends: the farther from one and the nearer to the other, the later.
    let (from_one, order, _) = stage.pass(|| part.rings(Some(order[size - 1])))?;
    let (from_other, _, _) = stage.pass(|| part.rings(Some(order[size - 1])))?;
    let keys = from_one.iter().zip(&from_other);
    let keys: Vec<u32> = keys.map(|(one, other)| size as u32 + one - other).collect();
    let places = stage.pass(|| ranks(&keys, 2 * size))?;
    let cut = stage.pass(|| best_cut(part, &places))?;
    let band = ((BAND * size as f64) as usize).max(1);
    let (begin, end) = (cut.saturating_sub(band).max(1), (cut + band).min(size - 1));
    // The separator will be near to the first side: it shall be the larger one.
    let is_turned = 2 * cut < size;
    let side = |vertex: usize| match (places[vertex], is_turned) {
        (place, _) if (begin..end).contains(&place) => Side::Between,
        (place, turned) if (place < begin) != turned => Side::First,
        _ => Side::Second,
    };
    let mut sides: Vec<Side> = (0..size).map(side).collect();
    separate(part, &mut sides, stage)?;
    Ok(sides)
}

/// The place of each key among all, which are below `bound`; of equal ones the first comes first.
fn ranks(keys: &[u32], bound: usize) -> Vec<usize> {
    let mut next = vec![0; bound + 1];
    for &key in keys {
        next[key as usize + 1] += 1;
    }
    for key in 0..bound {
        next[key + 1] += next[key];
    }
    let rank = |&key: &u32| {
        let rank = next[key as usize];
        next[key as usize] += 1;
        rank
    };
    keys.iter().map(rank).collect()
}

/// The number of vertices before the cut with the fewest edges across for the sizes of its sides.
fn best_cut(part: &Part, places: &[usize]) -> usize {
    let size = part.len();
    let mut changes = vec![0_i64; size];
    for (vertex, &place) in places.iter().enumerate() {
        for &other in part.neighbours_of(vertex) {
            changes[place] += match places[other as usize] > place {
                true => 1,
                false => -1,
            };
        }
    }
    let least = (LEAST_SHARE * size as f64) as usize;
    let mut across = 0;
    let mut best = (f64::INFINITY, size / 2);
    for (place, change) in changes.iter().enumerate() {
        let before = place + 1;
        across += change;
        if before >= least && size - before >= least {
            let cost = across as f64 / (before as f64 * (size - before) as f64);
            if cost < best.0 {
                best = (cost, before);
            }
        }
    }
    best.1
}
