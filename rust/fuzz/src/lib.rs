//! Inputs for every entry point of the library, made of a fuzzer's bytes, and what must be true
//! of what comes out: a finite result with the properties that the documentation promises, or a
//! refusal that says what is wrong. A system that cannot be solved is a finding.

mod deform;
mod flow;
mod guard;
mod image;
mod number;
mod pose;
mod pulls;
mod scales;
mod sets;
mod shape;

use arbitrary::Arbitrary;
use spectral_tv::{Error, Result};

use crate::shape::Shape;

/// A mesh, perhaps a bad one, and what is done with it.
#[derive(Debug, Arbitrary)]
pub struct Input {
    call: Call,
    shape: Shape,
}

#[derive(Debug, Arbitrary)]
enum Call {
    Decompose(scales::Decompose),
    Caricature(scales::Caricature),
    Accuracy(scales::Accuracy),
    Flow(flow::Flow),
    ConformalFlow(flow::ConformalFlow),
    Eigenpairs(flow::FewEigenpairs),
    Deform(deform::Deform),
    Drag(deform::Drag),
    Pose(pose::PoseOnce),
    DragPose(pose::Drag),
    Cosegment(sets::Cosegment),
    EigensetTest(sets::Set),
    Image(image::Pixels),
    Guard(guard::Shift),
}

impl Input {
    /// Makes the mesh and the call, and checks what comes out; whether there was a mesh.
    ///
    /// # Panics
    /// If a promise is broken.
    pub fn run(&self) -> bool {
        if let Call::Image(image) = &self.call {
            image.run();
            return true;
        }
        let Some(mesh) = self.shape.mesh() else {
            return false;
        };
        match &self.call {
            Call::Decompose(call) => call.run(&mesh),
            Call::Caricature(call) => call.run(&mesh),
            Call::Accuracy(call) => call.run(&mesh),
            Call::Flow(call) => call.run(&mesh),
            Call::ConformalFlow(call) => call.run(&mesh),
            Call::Eigenpairs(call) => call.run(&mesh),
            Call::Deform(call) => call.run(&mesh),
            Call::Drag(call) => call.run(&mesh),
            Call::Pose(call) => call.run(&mesh),
            Call::DragPose(call) => call.run(&mesh),
            Call::Cosegment(call) => call.run(&mesh),
            Call::EigensetTest(call) => call.run(&mesh),
            Call::Guard(call) => call.run(&mesh),
            Call::Image(_) => {}
        }
        true
    }
}

/// Has all work done by the calling thread, so that the same input takes the same way.
///
/// # Panics
/// If there is a pool already.
pub fn on_one_thread() {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread();
    pool.build_global().expect("the first pool");
}

/// What a call gave, or nothing where the input was refused and the message says why.
fn unless_refused<T>(outcome: Result<T>) -> Option<T> {
    match outcome {
        Ok(value) => Some(value),
        Err(error @ (Error::Solver(_) | Error::Cancelled)) => panic!("{error}"),
        Err(error) => {
            assert!(error.to_string().len() > 10, "{error}");
            None
        }
    }
}

fn assert_finite<'a>(name: &str, values: impl IntoIterator<Item = &'a f64>) {
    for value in values {
        assert!(value.is_finite(), "{name}: {value}");
    }
}

fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values
        .into_iter()
        .fold(0.0, |most, value| most.max(value.abs()))
}
