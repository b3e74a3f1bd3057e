//! Walks through the tree of units; units that do not depend on each other run side by side.

use rayon::prelude::*;

use crate::solver::cholesky::units::Unit;

/// Calls `work` with every unit up to `root`, the states of all below it and its own, once
/// it has been called for those below. `states` are those of everything up to `root`.
pub(super) fn upward<S: Send>(
    units: &[Unit],
    root: usize,
    states: &mut [S],
    work: &(impl Fn(&Unit, &[S], &mut S) + Sync),
) {
    let (below, own) = states.split_at_mut(states.len() - 1);
    in_parts(units, root, below, |unit, part| {
        upward(units, unit, part, work);
    });
    work(&units[root], below, &mut own[0]);
}

/// Calls `work` with every unit up to `root`, the states of all below it and its own, before
/// it is called for those below.
pub(super) fn downward<S: Send>(
    units: &[Unit],
    root: usize,
    states: &mut [S],
    work: &(impl Fn(&Unit, &mut [S], &mut S) + Sync),
) {
    let (below, own) = states.split_at_mut(states.len() - 1);
    work(&units[root], below, &mut own[0]);
    in_parts(units, root, below, |unit, part| {
        downward(units, unit, part, work);
    });
}

/// Calls `work` with each unit right below `root` and the states of everything up to it.
fn in_parts<S: Send>(
    units: &[Unit],
    root: usize,
    mut states: &mut [S],
    work: impl Fn(usize, &mut [S]) + Sync,
) {
    let mut parts = Vec::with_capacity(units[root].below.len());
    for &unit in &units[root].below {
        let count = unit - units[unit as usize].first + 1;
        let (part, rest) = states.split_at_mut(count as usize);
        parts.push((unit as usize, part));
        states = rest;
    }
    let parts = parts.into_par_iter().with_max_len(1);
    parts.for_each(|(unit, part)| work(unit, part));
}
