//! Solves with a factor: up the tree with L, down again with Lᵀ, for several functions at once.

use ndarray::{ArrayView2, ArrayViewMut2, Zip};
use pulp::{Arch, Simd, WithSimd};

use crate::solver::cholesky::lanes::{
    BLOCK, Lanes, add, add_left_over, gather, subtract, subtract_below,
};
use crate::solver::cholesky::number::{Number, Numbers, is_fused};
use crate::solver::cholesky::tree::{downward, upward};
use crate::solver::cholesky::units::{Node, Unit};

/// Parts of a sum down a column that do not wait for each other. They are the same whatever the registers.
const PARTS: usize = 8;

/// Solves K x = b for each row b of `right`, at most L; `write` has the solutions then.
pub(super) fn solve<N: Number, const L: usize>(
    units: &[Unit],
    numbers: &mut [Numbers<N>],
    right: ArrayView2<f64>,
) {
    let root = units.len() - 1;
    upward(units, root, numbers, &|unit, below, own| {
        let Numbers {
            panels,
            diagonal,
            lanes,
            ..
        } = own;
        gather::<L>(unit, right, lanes);
        let lanes = lanes.as_chunks_mut::<L>().0;
        add_left_over(units, unit, below, lanes);
        Arch::new().dispatch(Sweep::<N, L> {
            unit,
            factor: (panels, diagonal),
            x: lanes,
            is_upward: true,
        });
    });
    downward(units, root, numbers, &|unit, below, own| {
        let Numbers {
            panels,
            diagonal,
            lanes,
            ..
        } = own;
        let lanes = lanes.as_chunks_mut::<L>().0;
        Arch::new().dispatch(Sweep::<N, L> {
            unit,
            factor: (panels, diagonal),
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

/// Writes the last solutions, times `scale`. `places` has for each unknown its unit, and its column there.
pub(super) fn write<N: Number, const L: usize>(
    places: &[(u32, u32)],
    numbers: &[Numbers<N>],
    mut solutions: ArrayViewMut2<f64>,
    scale: f64,
) {
    let lanes: Vec<&[Lanes<L>]> = numbers
        .iter()
        .map(|numbers| numbers.lanes.as_chunks().0)
        .collect();
    for (lane, row) in solutions.rows_mut().into_iter().enumerate() {
        let solution = |value: &mut f64, &(unit, column): &(u32, u32)| {
            *value = scale * lanes[unit as usize][column as usize][lane];
        };
        Zip::from(row).and(places).par_for_each(solution);
    }
}

/// The columns of L, and the reciprocals of its diagonal.
type Factor<'a, N> = (&'a [N], &'a [f64]);

/// A way through one unit, with the instructions that the processor has.
struct Sweep<'a, N, const L: usize> {
    unit: &'a Unit,
    factor: Factor<'a, N>,
    x: &'a mut [Lanes<L>],
    is_upward: bool,
}

impl<N: Number, const L: usize> WithSimd for Sweep<'_, N, L> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self {
            unit, factor, x, ..
        } = self;
        match (self.is_upward, is_fused::<S>()) {
            (true, true) => up::<N, L, true>(unit, factor, x),
            (true, false) => up::<N, L, false>(unit, factor, x),
            (false, true) => down::<N, L, true>(unit, factor, x),
            (false, false) => down::<N, L, false>(unit, factor, x),
        }
    }
}

/// x ← L⁻¹ x.
#[inline(always)]
fn up<N: Number, const L: usize, const FUSED: bool>(
    unit: &Unit,
    (panels, diagonal): Factor<N>,
    x: &mut [Lanes<L>],
) {
    let mut sums: Vec<Lanes<L>> = Vec::new();
    for node in &unit.nodes {
        let (panel, rows, height, width) = parts(unit, panels, node);
        let own = &mut x[node.column..][..width];
        for column in 0..width {
            let values = &panel[column * height..][column..width];
            let scale = diagonal[node.column + column];
            let solved = own[column].map(|value| value * scale);
            own[column] = solved;
            for (value, factor) in own[column + 1..].iter_mut().zip(&values[1..]) {
                subtract::<L, FUSED>(value, factor.to_double(), &solved);
            }
        }
        let shape = (height, width);
        subtract_below::<N, L, FUSED>(panel, rows, shape, node.column, x, &mut sums);
    }
}

/// x ← L⁻ᵀ x.
#[inline(always)]
fn down<N: Number, const L: usize, const FUSED: bool>(
    unit: &Unit,
    (panels, diagonal): Factor<N>,
    x: &mut [Lanes<L>],
) {
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
            let columns: [&[N]; BLOCK] =
                std::array::from_fn(|c| &block[c * height + width..(c + 1) * height]);
            let mut sums: [Lanes<L>; BLOCK] = std::array::from_fn(|c| own[c]);
            for (row, known) in known.iter().enumerate() {
                for c in 0..BLOCK {
                    subtract::<L, FUSED>(&mut sums[c], columns[c][row].to_double(), known);
                }
            }
            own.copy_from_slice(&sums);
        }
        for column in done..width {
            let values = &panel[column * height..][width..height];
            subtract_product::<N, L, FUSED>(&mut own[column], values, &known);
        }
        for column in (0..width).rev() {
            let values = &panel[column * height..][column..width];
            let (own, solved) = own.split_at_mut(column + 1);
            let value = &mut own[column];
            for (factor, solved) in values[1..].iter().zip(solved) {
                subtract::<L, FUSED>(value, factor.to_double(), solved);
            }
            let scale = diagonal[node.column + column];
            *value = value.map(|value| value * scale);
        }
    }
}

/// sum −= Σ factor x.
#[inline(always)]
fn subtract_product<N: Number, const L: usize, const FUSED: bool>(
    sum: &mut Lanes<L>,
    factors: &[N],
    x: &[Lanes<L>],
) {
    let mut parts = [[0.0; L]; PARTS];
    let (blocks, rest) = factors.as_chunks::<PARTS>();
    let (x, x_rest) = x[..factors.len()].as_chunks::<PARTS>();
    for (factors, x) in blocks.iter().zip(x) {
        for part in 0..PARTS {
            subtract::<L, FUSED>(&mut parts[part], factors[part].to_double(), &x[part]);
        }
    }
    for (part, (factor, x)) in parts.iter_mut().zip(rest.iter().zip(x_rest)) {
        subtract::<L, FUSED>(part, factor.to_double(), x);
    }
    // By halves: none waits long for another.
    for half in [PARTS / 2, PARTS / 4, PARTS / 8] {
        for part in 0..half {
            let other = parts[part + half];
            add(&mut parts[part], &other);
        }
    }
    add(sum, &parts[0]);
}

/// Panel, rows below the diagonal block, height and width of a supernode.
#[inline(always)]
fn parts<'a, N>(
    unit: &'a Unit,
    panels: &'a [N],
    node: &Node,
) -> (&'a [N], &'a [u32], usize, usize) {
    let (height, width) = (node.height, node.width);
    let rows = &unit.rows[node.rows..][..height - width];
    (&panels[node.panel..][..height * width], rows, height, width)
}
