//! The class `Mesh`.

use std::sync::Arc;

use numpy::{IntoPyArray, PyArray1, PyArray2};
use pyo3::prelude::*;
use spectral_tv::mesh::TriangleMesh;
use spectral_tv::operators::positions;

use crate::arrays;
use crate::error::Failure;

/// A triangle mesh with V vertices and F triangles, checked once.
///
/// Zero-area triangles, boundaries, non-manifold edges, several components and vertices in no
/// triangle are accepted.
///
/// Parameters
/// ----------
/// vertices : (V, 3) array of numbers
///     Positions, in any unit of length.
/// triangles : (F, 3) array of integers
///     Indices of each triangle's corners.
///
/// Raises
/// ------
/// MeshError
///     Names the first vertex that is not finite or triangle whose index is out of range; or
///     says that the mesh has no triangles or spans no area.
#[pyclass(frozen, module = "spectral_tv")]
pub struct Mesh {
    pub inner: Arc<TriangleMesh>,
}

#[pymethods]
impl Mesh {
    #[new]
    fn new(vertices: &Bound<'_, PyAny>, triangles: &Bound<'_, PyAny>) -> Result<Self, Failure> {
        let vertices = arrays::positions("vertices", vertices)?;
        let triangles = arrays::index_triples("triangles", triangles)?;
        let mesh = TriangleMesh::new(vertices, &triangles)?;
        Ok(Self {
            inner: Arc::new(mesh),
        })
    }

    /// Positions, (V, 3); a copy.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        arrays::per_vertex(py, &positions(&self.inner))
    }

    /// Corners of the triangles, (F, 3) int64; a copy.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<i64>> {
        let triangles = self.inner.triangles();
        ndarray::Array2::from_shape_fn((triangles.len(), 3), |(face, corner)| {
            i64::from(triangles[face][corner])
        })
        .into_pyarray(py)
    }

    /// Area of the surface, length².
    #[getter]
    fn area(&self) -> f64 {
        self.inner.area()
    }

    /// Area of each triangle, (F,), length².
    #[getter]
    fn face_areas<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.inner.face_areas().to_vec().into_pyarray(py)
    }

    /// A third of the area of each vertex's triangles, (V,), length²; 0 in no triangle.
    #[getter]
    fn vertex_areas<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.inner.vertex_areas().to_vec().into_pyarray(py)
    }

    fn __repr__(&self) -> String {
        format!(
            "Mesh({} vertices, {} triangles, area {:.5e})",
            self.inner.vertex_count(),
            self.inner.triangles().len(),
            self.inner.area()
        )
    }
}
