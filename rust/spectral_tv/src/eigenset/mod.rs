//! Tests whether a set is an eigenset of NETV (Brokman et al. 2024).
//!
//! The function that is 1 on an eigenset, and another constant off it, is an eigenfunction: it
//! fades in a straight line under the flow.

mod criterion;
mod decay;
mod diffusion;
mod perimeter;
mod supersets;

pub use criterion::{EigensetTest, eigenset_test, eigenset_test_with};
