//! What a step changes, kept as precisely as it was solved for.

use ndarray::{Array2, ArrayView2, ArrayViewMut2, Zip, aview0};

use crate::error::has_usable_size;
use crate::parallel;

/// How many digits of an increment are worth keeping.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Precision {
    /// Where the system was factorized: the increment is exact to rounding.
    Double,
    /// Where it was solved by iteration, to some 1e-6 of the increment; rounding to single
    /// precision takes 6e-8 of it.
    Single,
}

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
        Self::Single { values, unit }
    }

    /// Adds `factor` times the increment to `sum` (C, V).
    pub(super) fn add_to(&self, factor: f64, sum: &mut Array2<f64>) {
        match self {
            Self::Double(values) => {
                let add = |sum: &mut f64, value: &f64| *sum += factor * value;
                Zip::from(sum).and(values).par_for_each(add);
            }
            Self::Single { values, unit } => {
                let factor = factor * unit;
                let add = |sum: &mut f64, value: &f32| *sum += factor * f64::from(*value);
                Zip::from(sum).and(values).par_for_each(add);
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
        }
    }

    /// The increment, (C, V).
    pub(super) fn values(&self) -> Array2<f64> {
        match self {
            Self::Double(values) => values.clone(),
            Self::Single { values, unit } => values.mapv(|value| unit * f64::from(value)),
        }
    }

    /// Its shape, (C, V).
    pub(super) fn dim(&self) -> (usize, usize) {
        match self {
            Self::Double(values) => values.dim(),
            Self::Single { values, .. } => values.dim(),
        }
    }

    /// Whether no number of it is broken.
    pub(super) fn is_usable(&self) -> bool {
        match self {
            Self::Double(values) => values.iter().all(|value| has_usable_size(*value)),
            Self::Single { values, unit } => {
                let are_finite = values.iter().all(|value| value.is_finite());
                are_finite && *unit > 0.0 && has_usable_size(*unit)
            }
        }
    }

    /// The precision it is kept in.
    pub(super) fn precision(&self) -> Precision {
        match self {
            Self::Double(_) => Precision::Double,
            Self::Single { .. } => Precision::Single,
        }
    }
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
        let nothing = Increment::new(&Array2::zeros((1, 2)), Precision::Single);
        assert_eq!(nothing.values(), Array2::zeros((1, 2)));
    }
}
