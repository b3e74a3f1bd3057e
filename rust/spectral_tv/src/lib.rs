//! Spectral total-variation processing of triangle meshes.
//!
//! The methods of Brokman, Burger and Gilboa 2024, "Spectral Total-Variation Processing of
//! Shapes – Theory and Applications": zero-homogeneous flows on a mesh, their spectral
//! transform, and filters made of it. Data flows through the modules in this order:
//!
//! [`mesh`] → [`operators`] → [`solver`] → [`minimization`] → [`flow`] → [`spectral`] → [`method`]
//!
//! [`deformation`] stands beside the flows and uses [`minimization`]. [`segmentation`] groups the
//! spectra that [`method`] gives. [`eigenset`] tests sets by their [`flow`]. [`image`] flows
//! pixels. All of them use [`monitor`], which tells them when to stop, and [`memory`], which tells
//! what fits.

#![forbid(unsafe_code)]

pub mod deformation;
pub mod discretization;
pub mod eigenset;
pub mod error;
pub mod flow;
pub mod image;
pub mod memory;
pub mod mesh;
pub mod method;
pub mod minimization;
pub mod monitor;
mod named;
pub mod operators;
mod parallel;
pub mod segmentation;
pub mod solver;
pub mod spectral;

pub use error::{ArgumentError, Error, Fault, Result};
pub use named::Named;
