//! What a step changes, kept as precisely as it was solved for.

use ndarray::{Array2, ArrayView2, ArrayViewMut2, Axis, Zip, aview0};
use rayon::prelude::*;

use crate::error::has_usable_size;
use crate::numbering::Numbering;
use crate::parallel;

/// Why rows of the arrays here are slices.
const CONTIGUOUS: &str = "functions are kept channel by channel";

/// How many digits of an increment are worth keeping.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Precision {
    /// Where the system was factorized in double precision: the increment is exact to rounding.
    Double,
    /// Where it was solved otherwise, to some 1e-6 of the increment at best; rounding to single
    /// precision takes 6e-8 of it.
    Single,
    /// The same on a mesh of one piece, once no other step is solved by its help: rounding leaves 1.5e-5 of
    /// the largest value nearby, which is what an iteration leaves of all.
    Short,
}

/// Values with one unit. They are neighbours in most meshes, and about as large.
const BLOCK: usize = 256;
/// Units in the largest value of a block.
const UNITS: f64 = i16::MAX as f64;

/// u_{k+1} − u_k, (C, V).
#[derive(Debug, Clone)]
pub enum Increment {
    /// As it is.
    Double(Array2<f64>),
    /// In single precision.
    Single {
        /// The increment by its unit.
        values: Array2<f32>,
        /// What `values` are multiples of: single precision has no room for lengths of any unit.
        unit: f64,
    },
    /// In 16 bits.
    Short {
        /// The increment by its units, at most 32767 of them.
        values: Array2<i16>,
        /// What each 256 `values` of a channel, one after the other, are multiples of, (C, ⌈V/256⌉).
        units: Array2<f64>,
    },
}

impl Increment {
    /// Keeps `values`.
    pub(super) fn new(values: &Array2<f64>, precision: Precision) -> Self {
        let nothing = aview0(&0.0);
        let nothing = nothing.broadcast(values.dim());
        Self::between(nothing.expect("of any shape"), values.view(), precision)
    }

    /// Keeps what leads from the state `before` to `now`, (C, V) each.
    pub(super) fn between(
        before: ArrayView2<f64>,
        now: ArrayView2<f64>,
        precision: Precision,
    ) -> Self {
        let both = Zip::from(now).and(before);
        if precision == Precision::Double {
            return Self::Double(both.par_map_collect(|now, before| now - before));
        }
        let largest = parallel::largest(now.ncols(), |vertices| {
            Zip::from(parallel::columns(now, vertices.clone()))
                .and(parallel::columns(before, vertices))
                .fold(0.0_f64, |max, now, before| max.max((now - before).abs()))
        });
        let unit = if largest > 0.0 { largest } else { 1.0 };
        let values = both.par_map_collect(|now, before| ((now - before) / unit) as f32);
        let single = Self::Single { values, unit };
        match precision {
            Precision::Short => single.shortened(),
            _ => single,
        }
    }

    /// Takes it from a numbering to that of the caller. To be done before it is in 16 bits, as these have units
    /// for neighbours.
    pub(super) fn renumber(&mut self, numbering: &Numbering) {
        match self {
            Self::Double(values) => *values = numbering.outwards(values.view()),
            Self::Single { values, .. } => *values = numbering.outwards(values.view()),
            Self::Short { .. } => {
                let values = numbering.outwards(self.values().view());
                *self = Self::new(&values, Precision::Short);
            }
        }
    }

    /// Keeps it in 16 bits, if it was in single precision.
    pub(super) fn shorten(&mut self) {
        if matches!(self, Self::Single { .. }) {
            *self = self.shortened();
        }
    }

    fn shortened(&self) -> Self {
        let Self::Single { values, unit } = self else {
            return self.clone();
        };
        let blocks = values.ncols().div_ceil(BLOCK);
        let mut units = Array2::zeros((values.nrows(), blocks));
        let mut short = parallel::zeros(values.dim());
        let channels = short.rows_mut().into_iter().zip(units.rows_mut());
        for ((mut short, mut units), values) in channels.zip(values.rows()) {
            let parts = short.axis_chunks_iter_mut(Axis(0), BLOCK).into_par_iter();
            let parts = parts.zip(values.axis_chunks_iter(Axis(0), BLOCK));
            let parts = parts.zip(units.axis_iter_mut(Axis(0)));
            parts
                .with_min_len(16)
                .for_each(|((mut short, values), mut own)| {
                    // NaN where a value is, which then stays one.
                    let larger = |max: f32, value: &f32| match max.is_nan() || value.abs() <= max {
                        true => max,
                        false => value.abs(),
                    };
                    let largest = values.iter().fold(0.0, larger);
                    let factor = i16::MAX as f32 / largest;
                    // Nothing is here, or less than single precision divides by.
                    let is_nothing = factor == f32::INFINITY;
                    let largest = if is_nothing { 0.0 } else { largest };
                    own.fill(f64::from(largest) * unit / UNITS);
                    if factor.is_finite() {
                        let rounded =
                            |short: &mut i16, value: &f32| *short = (value * factor).round() as i16;
                        Zip::from(&mut short).and(&values).for_each(rounded);
                    }
                });
        }
        Self::Short {
            values: short,
            units,
        }
    }

    /// Adds `factor` times the increment to `sum` (C, V).
    pub(super) fn add_to(&self, factor: f64, sum: &mut Array2<f64>) {
        parallel::columns_mut(&mut sum.view_mut()).for_each(|(first, mut columns)| {
            self.add_to_columns(factor, first, &mut columns);
        });
    }

    /// The same to the `columns` of a sum from `first` on.
    fn add_to_columns(&self, factor: f64, first: usize, columns: &mut ArrayViewMut2<f64>) {
        let range = first..first + columns.ncols();
        match self {
            Self::Double(values) => {
                let add = |sum: &mut f64, value: &f64| *sum += factor * value;
                let values = parallel::columns(values.view(), range);
                Zip::from(columns).and(values).for_each(add);
            }
            Self::Single { values, unit } => {
                let factor = factor * unit;
                let add = |sum: &mut f64, value: &f32| *sum += factor * f64::from(*value);
                let values = parallel::columns(values.view(), range);
                Zip::from(columns).and(values).for_each(add);
            }
            Self::Short { .. } => self.add_short(|_| factor, first, columns),
        }
    }

    /// Adds an increment in 16 bits, each vertex times the factor of its column, to the `columns` of a sum
    /// from `first` on.
    #[inline(always)]
    fn add_short(
        &self,
        factor: impl Fn(usize) -> f64,
        first: usize,
        columns: &mut ArrayViewMut2<f64>,
    ) {
        let Self::Short { values, units } = self else {
            return;
        };
        let count = columns.ncols();
        let rows = columns.rows_mut().into_iter().zip(values.rows());
        for ((row, values), units) in rows.zip(units.rows()) {
            let row = row.into_slice().expect(CONTIGUOUS);
            let values = &values.to_slice().expect(CONTIGUOUS)[first..first + count];
            let mut start = 0;
            while start < count {
                let end = count.min((first + start) / BLOCK * BLOCK + BLOCK - first);
                let unit = units[(first + start) / BLOCK];
                let parts = row[start..end].iter_mut().zip(&values[start..end]);
                for (column, (sum, value)) in (start..).zip(parts) {
                    *sum += factor(column) * unit * f64::from(*value);
                }
                start = end;
            }
        }
    }

    /// Adds the increment, each vertex times its factor, to the `columns` of a sum (C, V) from
    /// `first` on.
    pub(crate) fn add_weighted(
        &self,
        factors: &[f64],
        first: usize,
        columns: &mut ArrayViewMut2<f64>,
    ) {
        let range = first..first + factors.len();
        let rows = columns.rows_mut().into_iter();
        match self {
            Self::Double(values) => {
                for (mut row, values) in rows.zip(parallel::columns(values.view(), range).rows()) {
                    let add = |sum: &mut f64, value: &f64, factor: &f64| *sum += factor * value;
                    Zip::from(&mut row).and(values).and(factors).for_each(add);
                }
            }
            Self::Single { values, unit } => {
                for (mut row, values) in rows.zip(parallel::columns(values.view(), range).rows()) {
                    let add = |sum: &mut f64, value: &f32, factor: &f64| {
                        *sum += factor * unit * f64::from(*value);
                    };
                    Zip::from(&mut row).and(values).and(factors).for_each(add);
                }
            }
            Self::Short { .. } => self.add_short(|column| factors[column], first, columns),
        }
    }

    /// The increment, (C, V).
    pub(super) fn values(&self) -> Array2<f64> {
        match self {
            Self::Double(values) => values.clone(),
            Self::Single { values, unit } => values.mapv(|value| unit * f64::from(value)),
            Self::Short { values, .. } => weighted_sum(values.dim(), [(1.0, self)]),
        }
    }

    /// Its shape, (C, V).
    pub(super) fn dim(&self) -> (usize, usize) {
        match self {
            Self::Double(values) => values.dim(),
            Self::Single { values, .. } => values.dim(),
            Self::Short { values, .. } => values.dim(),
        }
    }

    /// Whether no number of it is broken, and all are there.
    pub(super) fn is_usable(&self) -> bool {
        match self {
            Self::Double(values) => values.iter().all(|value| has_usable_size(*value)),
            Self::Single { values, unit } => {
                let are_finite = values.iter().all(|value| value.is_finite());
                are_finite && *unit > 0.0 && has_usable_size(*unit)
            }
            Self::Short { values, units } => {
                let (channels, vertices) = values.dim();
                let is_unit = |unit: &f64| *unit >= 0.0 && has_usable_size(*unit);
                let is_whole = units.dim() == (channels, vertices.div_ceil(BLOCK));
                is_whole && values.is_standard_layout() && units.iter().all(is_unit)
            }
        }
    }

    /// The precision it is kept in.
    pub(super) fn precision(&self) -> Precision {
        match self {
            Self::Double(_) => Precision::Double,
            Self::Single { .. } => Precision::Single,
            Self::Short { .. } => Precision::Short,
        }
    }
}

/// Σ_k a_k times increments, of the given `shape` (C, V), added up in their order.
pub(super) fn weighted_sum<'a>(
    shape: (usize, usize),
    terms: impl IntoIterator<Item = (f64, &'a Increment)> + Clone + Sync,
) -> Array2<f64> {
    let mut sum = parallel::zeros(shape);
    parallel::columns_mut(&mut sum.view_mut()).for_each(|(first, mut columns)| {
        for (factor, increment) in terms.clone() {
            increment.add_to_columns(factor, first, &mut columns);
        }
    });
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::arr2;

    #[test]
    fn increments_of_any_unit_keep_the_digits_of_their_precision() {
        for unit in [1e-60, 1.0, 1e60] {
            let values = arr2(&[[0.1, -0.7, 1e-5], [0.0, 1.0 / 3.0, 2.0]]) * unit;
            for (precision, digits) in [(Precision::Double, 1e-16), (Precision::Single, 1e-7)] {
                let increment = Increment::new(&values, precision);
                assert_eq!(increment.precision(), precision);
                let mut sum = Array2::zeros((2, 3));
                increment.add_to(2.0, &mut sum);
                for (kept, twice) in [(increment.values(), 1.0), (sum, 2.0)] {
                    let errors = kept - &values * twice;
                    assert!(
                        errors
                            .iter()
                            .all(|error| error.abs() <= 4.0 * digits * unit)
                    );
                }
            }
        }
        for precision in [Precision::Single, Precision::Short] {
            let nothing = Increment::new(&Array2::zeros((1, 2)), precision);
            assert!(nothing.is_usable());
            assert_eq!(nothing.values(), Array2::zeros((1, 2)));
        }
    }

    #[test]
    fn short_increments_are_within_half_a_unit_of_the_largest_nearby() {
        // Three blocks, each far larger than the one before, the last not whole.
        let value = |channel: usize, vertex: usize| {
            let noise = (1e4 * (vertex + 7 * channel) as f64).sin();
            noise * 1e3_f64.powi((vertex / BLOCK) as i32) * 1e-40
        };
        let values = Array2::from_shape_fn((2, 2 * BLOCK + 44), |(c, v)| value(c, v));
        let mut increment = Increment::new(&values, Precision::Single);
        increment.shorten();
        assert_eq!(increment.precision(), Precision::Short);
        assert!(increment.is_usable());
        let kept = increment.values();
        for (channel, found) in kept.rows().into_iter().enumerate() {
            for (vertex, found) in found.iter().enumerate() {
                let unit = 1e3_f64.powi((vertex / BLOCK) as i32) * 1e-40 / UNITS;
                assert!((found - values[[channel, vertex]]).abs() < 0.51 * unit);
            }
        }
        // What is kept already loses no more than single precision does.
        let again = Increment::new(&kept, Precision::Short).values();
        let largest = kept.iter().fold(0.0_f64, |max, value| max.max(value.abs()));
        assert!(
            (&again - &kept)
                .iter()
                .all(|off| off.abs() < 1e-7 * largest)
        );
        // From any column on, and with a factor for each.
        for first in [0, 100, BLOCK, 2 * BLOCK + 1] {
            let factors: Vec<f64> = (first..kept.ncols()).map(|v| 0.5 + v as f64).collect();
            let mut sum = Array2::zeros((2, factors.len()));
            increment.add_weighted(&factors, first, &mut sum.view_mut());
            for ((channel, column), sum) in sum.indexed_iter() {
                let expected = factors[column] * kept[[channel, first + column]];
                assert!((sum - expected).abs() <= 1e-12 * expected.abs());
            }
        }
    }

    #[test]
    fn short_increments_hide_no_broken_value() {
        let values = arr2(&[[1.0, f64::NAN, 0.5]]);
        let increment = Increment::new(&values, Precision::Short);
        assert!(!increment.is_usable());
        assert!(increment.values().iter().any(|value| value.is_nan()));
    }
}
