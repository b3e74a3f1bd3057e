//! The function that starts to find a rig in a pose.

use std::sync::Arc;

use ndarray::Array2;
use pyo3::prelude::*;
use spectral_tv::monitor::Stage;
use spectral_tv::posing::{Rig, rig_with};

use crate::arrays;
use crate::error::Failure;
use crate::job::Job;
use crate::mesh::Mesh;
use crate::results::Fields;

#[pyfunction]
pub fn start_rig(
    mesh: &Mesh,
    vertices: &Bound<'_, PyAny>,
    rotations: &Bound<'_, PyAny>,
) -> Result<Job, Failure> {
    let mut displacement = arrays::shape("vertices", vertices)?;
    let (rotations, _) = arrays::channels("rotations", rotations)?;
    let surface = Arc::clone(&mesh.inner);
    for (mut vertex, rest) in displacement
        .columns_mut()
        .into_iter()
        .zip(surface.vertices())
    {
        for (axis, rest) in rest.iter().enumerate() {
            vertex[axis] -= rest;
        }
    }
    let work = move |stage: Stage| rig_with(&surface, displacement.view(), rotations.view(), stage);
    Job::start(work, |py, rig: Rig| {
        let labels = rig.labels.into_iter();
        let labels = labels.map(|label| label.map_or(-1, i64::from));
        let parents = rig.parents.into_iter();
        let parents = parents.map(|parent| parent.map_or(-1, |parent| parent as i64));
        let points = |points: Vec<[f64; 3]>| {
            let rows = Array2::from_shape_fn((3, points.len()), |(axis, p)| points[p][axis]);
            arrays::per_vertex(py, rows.view())
        };
        let turns = &rig.rotations;
        let rotations = Array2::from_shape_fn((4, turns.len()), |(part, p)| turns[p][part]);
        let fields = Fields::new(py)
            .with("labels", arrays::collected(py, labels)?)?
            .with("weights", arrays::per_vertex(py, rig.weights.view())?)?
            .with("parents", arrays::collected(py, parents)?)?
            .with("heads", points(rig.heads)?)?
            .with("tails", points(rig.tails)?)?
            .with("rotations", arrays::per_vertex(py, rotations.view())?)?
            .with("translations", points(rig.translations)?)?;
        Ok(fields.made("Rig")?)
    })
}
