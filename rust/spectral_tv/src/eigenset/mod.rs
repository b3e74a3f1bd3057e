//! Whether a set is an eigenset of NETV: whether the function that is 1 on it and constant off it
//! is an eigenfunction, which fades in a straight line under the flow (Brokman et al. 2024).

mod criterion;
mod decay;
mod perimeter;
mod supersets;

pub use criterion::{EigensetTest, eigenset_test};
