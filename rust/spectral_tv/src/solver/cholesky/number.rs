//! The numbers of a factor: in double precision, or in single where solutions need not be exact.

use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use faer::traits::RealField;
use pulp::Simd;

use crate::error::Result;
use crate::memory::zeros;
use crate::solver::cholesky::units::Unit;

/// f64 or f32.
pub trait Number:
    Copy
    + Default
    + Send
    + Sync
    + PartialOrd
    + RealField
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + 'static
{
    /// 0 and 1.
    const ZERO: Self;
    /// See [`Self::ZERO`].
    const ONE: Self;
    /// Whether registers hold twice as many as in double precision.
    const IS_SINGLE: bool;
    /// Entries of L below this are taken for 0. Far from the diagonal they fade by powers. Subnormal ones and
    /// products would take a hundred times as long.
    const TINY: Self;

    /// The nearest of these numbers.
    fn from_double(value: f64) -> Self;
    /// The same number.
    fn to_double(self) -> f64;
    /// √x.
    fn root(self) -> Self;
    /// 1/x.
    fn inverse(self) -> Self;
    /// Whether it is neither infinite nor NaN.
    fn is_usable(self) -> bool;
    /// `self` · `factor` + `sum`, rounded once.
    fn fused(self, factor: Self, sum: Self) -> Self;

    /// 0 instead of a tiny number.
    #[inline(always)]
    fn cleared(self) -> Self {
        match -Self::TINY < self && self < Self::TINY {
            true => Self::ZERO,
            false => self,
        }
    }
}

macro_rules! number {
    ($number:ident, $is_single:literal, $tiny:literal) => {
        impl Number for $number {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const IS_SINGLE: bool = $is_single;
            const TINY: Self = $tiny;

            #[inline(always)]
            fn from_double(value: f64) -> Self {
                value as Self
            }

            #[inline(always)]
            fn to_double(self) -> f64 {
                self.into()
            }

            #[inline(always)]
            fn root(self) -> Self {
                self.sqrt()
            }

            #[inline(always)]
            fn inverse(self) -> Self {
                self.recip()
            }

            #[inline(always)]
            fn is_usable(self) -> bool {
                self.is_finite()
            }

            #[inline(always)]
            fn fused(self, factor: Self, sum: Self) -> Self {
                self.mul_add(factor, sum)
            }
        }
    };
}

number!(f64, false, 0.0);
number!(f32, true, 1e-15);

/// Whether a processor multiplies and adds at once: all with wide registers do.
#[inline(always)]
pub(super) fn is_fused<S: Simd>() -> bool {
    S::F64_LANES > 1
}

/// The numbers of one unit.
#[derive(Debug)]
pub struct Numbers<N> {
    /// The columns of L, supernode by supernode.
    pub(super) panels: Vec<N>,
    /// The reciprocals of its diagonal.
    pub(super) diagonal: Vec<f64>,
    /// Updates in the making; at last that of the root, at the start.
    pub(super) stack: Vec<N>,
    /// The functions solved for, in columns and boundary. While it is factorized, what rows sum to.
    pub(super) lanes: Vec<f64>,
}

impl<N: Number> Numbers<N> {
    /// For a unit.
    ///
    /// # Errors
    /// [`crate::Error::Memory`].
    pub(super) fn new(unit: &Unit, what: &str, advice: &str) -> Result<Self> {
        Ok(Self {
            panels: zeros(unit.panel_length, what, advice)?,
            diagonal: zeros(unit.columns.len(), what, advice)?,
            stack: zeros(unit.stack_length, what, advice)?,
            lanes: Vec::new(),
        })
    }
}
