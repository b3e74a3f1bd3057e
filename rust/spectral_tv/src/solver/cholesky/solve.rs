//! Solves with a factor: up the tree with L, down again with Lᵀ, for several functions at once.

use ndarray::{ArrayView2, ArrayViewMut2, Zip};
use pulp::{Arch, Simd, WithSimd};

use crate::solver::cholesky::factor::Numbers;
use crate::solver::cholesky::tree::{downward, upward};
use crate::solver::cholesky::units::{Node, Unit};

type Lanes<const L: usize> = [f64; L];

/// Columns that rows are read once for.
const BLOCK: usize = 4;
/// Parts of a sum down a column that do not wait for each other. They are the same whatever the registers.
const PARTS: usize = 8;

/// Solves K x = b for each row b of `right`, at most L; `write` has the solutions then.
pub(super) fn solve<const L: usize>(
    units: &[Unit],
    numbers: &mut [Numbers],
    right: ArrayView2<f64>,
) {
    let root = units.len() - 1;
    upward(units, root, numbers, &|unit, below, own| {
        let Numbers { panels, lanes, .. } = own;
        gather::<L>(unit, right, lanes);
        let lanes = lanes.as_chunks_mut::<L>().0;
        for &child in &unit.below {
            let child_numbers = &below[(child - unit.first) as usize];
            let child = &units[child as usize];
            let left_over = &child_numbers.lanes.as_chunks::<L>().0[child.columns.len()..];
            for (&place, value) in child.boundary.iter().zip(left_over) {
                add(&mut lanes[place as usize], value);
            }
        }
        Arch::new().dispatch(Sweep::<L> {
            unit,
            panels,
            x: lanes,
            is_upward: true,
        });
    });
    downward(units, root, numbers, &|unit, below, own| {
        let Numbers { panels, lanes, .. } = own;
        let lanes = lanes.as_chunks_mut::<L>().0;
        Arch::new().dispatch(Sweep::<L> {
            unit,
            panels,
            x: &mut *lanes,
            is_upward: false,
        });
        for &child in &unit.below {
            let child_numbers = &mut below[(child - unit.first) as usize];
            let child = &units[child as usize];
            let known = &mut child_numbers.lanes.as_chunks_mut::<L>().0[child.columns.len()..];
            for (&place, value) in child.boundary.iter().zip(known) {
                *value = lanes[place as usize];
            }
        }
    });
}

/// Writes the last solutions. `places` has for each unknown its unit, and its column there.
pub(super) fn write<const L: usize>(
    places: &[(u32, u32)],
    numbers: &[Numbers],
    mut solutions: ArrayViewMut2<f64>,
) {
    let lanes: Vec<&[Lanes<L>]> = numbers
        .iter()
        .map(|numbers| numbers.lanes.as_chunks().0)
        .collect();
    for (lane, row) in solutions.rows_mut().into_iter().enumerate() {
        let solution = |value: &mut f64, &(unit, column): &(u32, u32)| {
            *value = lanes[unit as usize][column as usize][lane];
        };
        Zip::from(row).and(places).par_for_each(solution);
    }
}

/// The right-hand sides in a unit's columns, and zeros in its boundary.
fn gather<const L: usize>(unit: &Unit, right: ArrayView2<f64>, lanes: &mut Vec<f64>) {
    lanes.clear();
    lanes.resize(L * (unit.columns.len() + unit.boundary.len()), 0.0);
    let lanes = lanes.as_chunks_mut::<L>().0;
    for (lane, row) in right.rows().into_iter().enumerate() {
        for (&vertex, lanes) in unit.columns.iter().zip(&mut *lanes) {
            lanes[lane] = row[vertex as usize];
        }
    }
}

/// A way through one unit, with the instructions that the processor has.
struct Sweep<'a, const L: usize> {
    unit: &'a Unit,
    panels: &'a [f64],
    x: &'a mut [Lanes<L>],
    is_upward: bool,
}

impl<const L: usize> WithSimd for Sweep<'_, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        match self.is_upward {
            true => up(self.unit, self.panels, self.x),
            false => down(self.unit, self.panels, self.x),
        }
    }
}

/// x ← L⁻¹ x.
#[inline(always)]
fn up<const L: usize>(unit: &Unit, panels: &[f64], x: &mut [Lanes<L>]) {
    let mut sums: Vec<Lanes<L>> = Vec::new();
    for node in &unit.nodes {
        let (panel, rows, height, width) = parts(unit, panels, node);
        let own = &mut x[node.column..][..width];
        for column in 0..width {
            let values = &panel[column * height..][column..width];
            let solved = own[column].map(|value| value * values[0]);
            own[column] = solved;
            for (value, factor) in own[column + 1..].iter_mut().zip(&values[1..]) {
                subtract(value, *factor, &solved);
            }
        }
        sums.clear();
        sums.resize(rows.len(), [0.0; L]);
        let blocks = panel.chunks_exact(BLOCK * height);
        for (block, own) in blocks.zip(own.chunks_exact(BLOCK)) {
            let columns: [&[f64]; BLOCK] =
                std::array::from_fn(|c| &block[c * height + width..(c + 1) * height]);
            for (row, sum) in sums.iter_mut().enumerate() {
                for c in 0..BLOCK {
                    subtract(sum, columns[c][row], &own[c]);
                }
            }
        }
        let columns = panel.chunks_exact(height).zip(&*own);
        for (values, own) in columns.skip(width / BLOCK * BLOCK) {
            for (sum, value) in sums.iter_mut().zip(&values[width..]) {
                subtract(sum, *value, own);
            }
        }
        for (&row, sum) in rows.iter().zip(&sums) {
            add(&mut x[row as usize], sum);
        }
    }
}

/// x ← L⁻ᵀ x.
#[inline(always)]
fn down<const L: usize>(unit: &Unit, panels: &[f64], x: &mut [Lanes<L>]) {
    let mut known: Vec<Lanes<L>> = Vec::new();
    for node in unit.nodes.iter().rev() {
        let (panel, rows, height, width) = parts(unit, panels, node);
        known.clear();
        known.extend(rows.iter().map(|&row| x[row as usize]));
        let own = &mut x[node.column..][..width];
        // The registers are full of several functions, but not of one.
        let done = match L {
            1 => 0,
            _ => width / BLOCK * BLOCK,
        };
        for (block, own) in panel[..done * height]
            .chunks_exact(BLOCK * height)
            .zip(own.chunks_exact_mut(BLOCK))
        {
            let columns: [&[f64]; BLOCK] =
                std::array::from_fn(|c| &block[c * height + width..(c + 1) * height]);
            let mut sums: [Lanes<L>; BLOCK] = std::array::from_fn(|c| own[c]);
            for (row, known) in known.iter().enumerate() {
                for c in 0..BLOCK {
                    subtract(&mut sums[c], columns[c][row], known);
                }
            }
            own.copy_from_slice(&sums);
        }
        for column in done..width {
            let values = &panel[column * height..][width..height];
            subtract_product(&mut own[column], values, &known);
        }
        for column in (0..width).rev() {
            let values = &panel[column * height..][column..width];
            let (own, solved) = own.split_at_mut(column + 1);
            let value = &mut own[column];
            for (factor, solved) in values[1..].iter().zip(solved) {
                subtract(value, *factor, solved);
            }
            *value = value.map(|value| value * values[0]);
        }
    }
}

/// sum −= Σ factor x.
#[inline(always)]
fn subtract_product<const L: usize>(sum: &mut Lanes<L>, factors: &[f64], x: &[Lanes<L>]) {
    let mut parts = [[0.0; L]; PARTS];
    let (blocks, rest) = factors.as_chunks::<PARTS>();
    let (x, x_rest) = x[..factors.len()].as_chunks::<PARTS>();
    for (factors, x) in blocks.iter().zip(x) {
        for part in 0..PARTS {
            subtract(&mut parts[part], factors[part], &x[part]);
        }
    }
    for (part, (factor, x)) in parts.iter_mut().zip(rest.iter().zip(x_rest)) {
        subtract(part, *factor, x);
    }
    for part in &parts {
        add(sum, part);
    }
}

/// Panel, rows below the diagonal block, height and width of a supernode.
#[inline(always)]
fn parts<'a>(
    unit: &'a Unit,
    panels: &'a [f64],
    node: &Node,
) -> (&'a [f64], &'a [u32], usize, usize) {
    let (height, width) = (node.height, node.width);
    let rows = &unit.rows[node.rows..][..height - width];
    (&panels[node.panel..][..height * width], rows, height, width)
}

#[inline(always)]
fn add<const L: usize>(sum: &mut Lanes<L>, value: &Lanes<L>) {
    for lane in 0..L {
        sum[lane] += value[lane];
    }
}

/// sum −= factor x.
#[inline(always)]
fn subtract<const L: usize>(sum: &mut Lanes<L>, factor: f64, x: &Lanes<L>) {
    for lane in 0..L {
        sum[lane] -= factor * x[lane];
    }
}
