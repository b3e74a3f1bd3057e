#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
// Without the feature `internals`, part of what tests, benchmarks and bindings reach is unused.
#![cfg_attr(not(feature = "internals"), allow(dead_code, unused_imports))]

pub mod deformation;
pub mod discretization;
pub mod eigenset;
mod elements;
mod error;
pub mod flow;
mod graph;
pub mod guard;
pub mod image;
#[cfg(not(feature = "internals"))]
mod memory;
#[cfg(feature = "internals")]
pub mod memory;
pub mod mesh;
pub mod method;
#[cfg(not(feature = "internals"))]
mod minimization;
#[cfg(feature = "internals")]
pub mod minimization;
pub mod monitor;
mod named;
pub mod nearest;
mod numbering;
#[cfg(not(feature = "internals"))]
mod operators;
#[cfg(feature = "internals")]
pub mod operators;
mod parallel;
pub mod posing;
pub mod segmentation;
#[cfg(not(feature = "internals"))]
mod solver;
#[cfg(feature = "internals")]
pub mod solver;
pub mod spectral;
pub mod thickness;

pub use error::{ArgumentError, Error, Fault, Result};
pub use named::Named;
pub use ndarray;
