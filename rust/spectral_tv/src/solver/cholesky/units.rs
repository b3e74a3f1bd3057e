//! Units: parts of the elimination tree, each the work of one thread. The tree of units says which
//! of them wait for which.

use std::ops::Range;

use rayon::prelude::*;
use sprs::CsMatI;

use crate::error::{Error, Result};
use crate::monitor::Stage;
use crate::parallel;
use crate::solver::cholesky::supernodes::{NONE, Supernodes};

/// Share of all multiplications that is worth handing to another thread.
const SHARE: f64 = 1.0 / 48.0;

/// A part of the elimination tree: a supernode with all below it, but for other units.
#[derive(Debug, Default)]
pub(super) struct Unit {
    /// In order of elimination; the last one is the root.
    pub nodes: Vec<Node>,
    /// Rows below the diagonal blocks of all nodes: columns of the unit, then rows of `boundary`.
    pub rows: Vec<u32>,
    /// For each of them, its row in the parent's front.
    pub places: Vec<u32>,
    /// Children of all nodes.
    pub children: Vec<Child>,
    /// Which entry of the caller's matrix goes to which of the panels.
    pub entries: Vec<(u32, u32)>,
    /// The caller's index of each column.
    pub columns: Vec<u32>,
    /// For each row below the root, its place in the columns and boundary of the unit above.
    pub boundary: Vec<u32>,
    /// The units right below, and the first of all below: they stand together.
    pub below: Vec<u32>,
    pub first: u32,
    /// Numbers that the panels take, and the updates in the making.
    pub panel_length: usize,
    pub stack_length: usize,
}

/// A supernode of a unit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    /// First column, number of columns, and rows of its front, its columns included.
    pub column: usize,
    pub width: usize,
    pub height: usize,
    /// Where its panel, its rows, and its children begin, and the number of these.
    pub panel: usize,
    pub rows: usize,
    pub children: usize,
    pub child_count: usize,
    /// Where its update is made, and then kept, in the stack.
    pub scratch: usize,
    pub update: usize,
}

/// A supernode whose update goes to another's front.
#[derive(Debug, Clone, Copy)]
pub(super) struct Child {
    /// The unit whose root it is, if that is another one.
    pub unit: Option<u32>,
    /// Where its update is, and of how many columns and rows.
    pub update: usize,
    pub size: usize,
    /// Where its rows' places begin in its unit's.
    pub places: usize,
}

/// Splits the tree into units of at least `least_work` multiplications each, which come after
/// those below them; the last one holds all that is left.
///
/// # Errors
/// [`Error::Solver`] if the index range does not suffice, or [`Error::Cancelled`].
pub(super) fn split(
    nodes: &Supernodes,
    lower: &CsMatI<f64, u32>,
    least_work: f64,
    stage: Stage,
) -> Result<Vec<Unit>> {
    let (owners, count) = stage.pass(|| owners(nodes, least_work))?;
    let mut builder = Builder {
        nodes,
        units: (0..count).map(|_| Unit::default()).collect(),
        roots: vec![NONE; count],
        locals: vec![0; nodes.order.len()],
        indices: vec![0; nodes.len()],
        owners,
    };
    stage.pass(|| builder.place_nodes())?;
    builder.place_rows(stage)?;
    builder.place_children();
    builder.place_entries(lower, stage)?;
    Ok(builder.units)
}

/// The unit of each supernode, and the number of units.
fn owners(nodes: &Supernodes, least_work: f64) -> (Vec<u32>, usize) {
    // One more, above all roots.
    let above = |node: usize| (nodes.parents[node] as usize).min(nodes.len());
    let mut work = vec![0.0; nodes.len() + 1];
    for node in 0..nodes.len() {
        work[node] += nodes.work(node);
        work[above(node)] += work[node];
    }
    let least = least_work.max(SHARE * work[nodes.len()]);
    // A unit ends where two that are worth it meet.
    let mut heavy_children = vec![0_usize; nodes.len() + 1];
    for node in (0..nodes.len()).filter(|&node| work[node] >= least) {
        heavy_children[above(node)] += 1;
    }
    let is_root = |node: usize| work[node] >= least && heavy_children[above(node)] > 1;
    let last = (0..nodes.len()).filter(|&node| is_root(node)).count();
    let mut owners = vec![last as u32; nodes.len() + 1];
    let mut next = last as u32;
    for node in (0..nodes.len()).rev() {
        owners[node] = owners[above(node)];
        if is_root(node) {
            next -= 1;
            owners[node] = next;
        }
    }
    owners.truncate(nodes.len());
    (owners, last + 1)
}

/// Units in the making.
struct Builder<'a> {
    nodes: &'a Supernodes,
    units: Vec<Unit>,
    owners: Vec<u32>,
    /// The last supernode of each unit.
    roots: Vec<u32>,
    /// Place of each column in its unit, and of each supernode.
    locals: Vec<u32>,
    indices: Vec<u32>,
}

impl Builder<'_> {
    /// Gives every supernode its place in its unit, and every unit its place in the tree.
    fn place_nodes(&mut self) {
        let nodes = self.nodes;
        for index in 0..nodes.len() {
            let owner = self.owners[index] as usize;
            let unit = &mut self.units[owner];
            let (begin, width) = (nodes.begins[index], nodes.width(index));
            let (column, height) = (unit.columns.len(), width + nodes.rows(index).len());
            for offset in 0..width {
                self.locals[begin as usize + offset] = (column + offset) as u32;
                unit.columns.push(nodes.order[begin as usize + offset]);
            }
            self.indices[index] = unit.nodes.len() as u32;
            self.roots[owner] = index as u32;
            unit.nodes.push(Node {
                column,
                width,
                height,
                panel: unit.panel_length,
                rows: 0,
                children: 0,
                child_count: 0,
                scratch: 0,
                update: 0,
            });
            unit.panel_length += width * height;
        }
        for index in 0..self.units.len() {
            let below = &self.units[index].below;
            let first = below.first().map(|&below| self.units[below as usize].first);
            self.units[index].first = first.unwrap_or(index as u32);
            if let Some(above) = self.unit_above(index) {
                self.units[above].below.push(index as u32);
            }
        }
    }

    fn unit_above(&self, unit: usize) -> Option<usize> {
        if unit + 1 == self.units.len() {
            return None;
        }
        let parent = self.nodes.parents[self.roots[unit] as usize];
        let owner = self.owners.get(parent as usize);
        Some(owner.map_or(self.units.len() - 1, |&owner| owner as usize))
    }

    /// Gives every row its place in its unit, and in the front above.
    fn place_rows(&mut self, stage: Stage) -> Result<()> {
        let nodes = self.nodes;
        let placed = |index: usize, placed: &mut Vec<(u32, u32)>| {
            let (owner, parent) = (self.owners[index] as usize, nodes.parents[index] as usize);
            let place = |&row: &u32| (self.local(owner, row), front_row(nodes, parent, row) as u32);
            placed.extend(nodes.rows(index).iter().map(place));
        };
        let piece = |indices: Range<usize>| {
            let mut rows = Vec::new();
            indices.clone().for_each(|index| placed(index, &mut rows));
            (indices, rows)
        };
        let pieces = stage.pass(|| parallel::parts(nodes.len(), piece))?;
        for (indices, rows) in pieces {
            let mut rows = &rows[..];
            stage.for_each(indices, |index| {
                let (own, rest) = rows.split_at(nodes.rows(index).len());
                rows = rest;
                let unit = &mut self.units[self.owners[index] as usize];
                unit.nodes[self.indices[index] as usize].rows = unit.rows.len();
                unit.rows.extend(own.iter().map(|&(row, _)| row));
                unit.places.extend(own.iter().map(|&(_, above)| above));
            })?;
        }
        for index in 0..self.units.len() {
            if let Some(above) = self.unit_above(index) {
                let rows = nodes.rows(self.roots[index] as usize).iter();
                let boundary = rows.map(|&row| self.local(above, row)).collect();
                self.units[index].boundary = boundary;
            }
        }
        Ok(())
    }

    /// Where a column, or one above the root, is among a unit's columns and boundary.
    fn local(&self, unit: usize, column: u32) -> u32 {
        let owner = self.nodes.begins.partition_point(|&begin| begin <= column) - 1;
        if self.owners[owner] as usize == unit {
            return self.locals[column as usize];
        }
        let boundary = self.nodes.rows(self.roots[unit] as usize);
        let place = boundary.partition_point(|&row| row < column);
        (self.units[unit].columns.len() + place) as u32
    }

    /// Links supernodes with those below them, and lays out where updates are made.
    fn place_children(&mut self) {
        let nodes = self.nodes;
        let mut lists = vec![Vec::new(); nodes.len()];
        for index in 0..nodes.len() {
            if let Some(list) = lists.get_mut(nodes.parents[index] as usize) {
                list.push(index);
            }
        }
        let mut tops = vec![0; self.units.len()];
        for (index, list) in lists.iter().enumerate() {
            let owner = self.owners[index] as usize;
            let top = &mut tops[owner];
            let (scratch, mut update) = (*top, *top);
            let first = self.units[owner].children.len();
            for &child in list {
                let other = self.owners[child] as usize;
                let node = self.units[other].nodes[self.indices[child] as usize];
                let is_own = other == owner;
                if is_own {
                    update = update.min(node.update);
                }
                let child = Child {
                    unit: (!is_own).then_some(other as u32),
                    update: node.update,
                    size: node.height - node.width,
                    places: node.rows,
                };
                self.units[owner].children.push(child);
            }
            let unit = &mut self.units[owner];
            let node = &mut unit.nodes[self.indices[index] as usize];
            let size = node.height - node.width;
            (node.scratch, node.update) = (scratch, update);
            (node.children, node.child_count) = (first, list.len());
            unit.stack_length = unit.stack_length.max(scratch + size * size);
            *top = update + size * size;
        }
    }

    /// Finds the place of every entry of the matrix in the panels.
    fn place_entries(&mut self, lower: &CsMatI<f64, u32>, stage: Stage) -> Result<()> {
        let nodes = self.nodes;
        if self
            .units
            .iter()
            .any(|unit| u32::try_from(unit.panel_length).is_err())
        {
            return Err(Error::Solver("the factor has too many entries".into()));
        }
        let starts = lower.proper_indptr();
        let place = |ends: [usize; 2]| {
            let [a, b] = ends.map(|vertex| nodes.places[vertex]);
            let (column, row) = (a.min(b), a.max(b));
            let index = nodes.begins.partition_point(|&begin| begin <= column) - 1;
            let owner = self.owners[index];
            let node = &self.units[owner as usize].nodes[self.indices[index] as usize];
            let offset = (column - nodes.begins[index]) as usize * node.height;
            (
                owner,
                (node.panel + offset + front_row(nodes, index, row)) as u32,
            )
        };
        let in_columns = |columns: Range<usize>| {
            let in_column = |column: usize| {
                let rows = &lower.indices()[starts[column] as usize..starts[column + 1] as usize];
                let place = &place;
                rows.iter().map(move |&row| place([column, row as usize]))
            };
            columns.flat_map(in_column).collect::<Vec<_>>()
        };
        let placed = stage.pass(|| parallel::parts(lower.cols(), in_columns))?;
        stage.for_each(
            (0..).zip(placed.into_iter().flatten()),
            |(entry, (owner, place))| {
                self.units[owner as usize].entries.push((entry, place));
            },
        )?;
        let sort =
            |unit: &mut Unit| stage.pass(|| unit.entries.sort_unstable_by_key(|&(_, place)| place));
        self.units.par_iter_mut().try_for_each(sort)
    }
}

/// Which row of a supernode's front is that of a column.
fn front_row(nodes: &Supernodes, node: usize, column: u32) -> usize {
    match column < nodes.begins[node + 1] {
        true => (column - nodes.begins[node]) as usize,
        false => nodes.width(node) + nodes.rows(node).partition_point(|&row| row < column),
    }
}
