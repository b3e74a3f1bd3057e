//! What turns a displacement into a shape.

use std::sync::Arc;

use ndarray::Array2;
use pyo3::prelude::*;
use spectral_tv::mesh::TriangleMesh;

use crate::arrays;
use crate::error::Failure;
use crate::mesh::Mesh;
use crate::results::Fields;

/// A mesh at rest, and its vertices that nothing holds.
pub struct Shape {
    pub mesh: Arc<TriangleMesh>,
    unconstrained: Vec<i64>,
}

impl Shape {
    /// `floating`: for each vertex, whether it is in a component without constraints.
    pub fn new(mesh: &Mesh, floating: &[bool]) -> Self {
        let vertices = (0_i64..).zip(floating);
        Self {
            mesh: Arc::clone(&mesh.inner),
            unconstrained: vertices
                .filter_map(|(vertex, &floating)| floating.then_some(vertex))
                .collect(),
        }
    }

    /// The fields that every result has: where a displacement takes the vertices, and those that
    /// nothing holds.
    pub fn displaced<'py>(
        &self,
        py: Python<'py>,
        displacement: Array2<f64>,
    ) -> Result<Fields<'py>, Failure> {
        let mut vertices = displacement;
        for (mut vertex, rest) in vertices.columns_mut().into_iter().zip(self.mesh.vertices()) {
            for (axis, rest) in rest.iter().enumerate() {
                vertex[axis] += rest;
            }
        }
        let fields = Fields::new(py)
            .with("vertices", arrays::per_vertex(py, vertices.view())?)?
            .with("unconstrained", arrays::array_of(py, &self.unconstrained)?)?;
        Ok(fields)
    }
}
