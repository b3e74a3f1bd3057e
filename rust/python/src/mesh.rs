//! The class `Mesh`.

use std::sync::Arc;

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use spectral_tv::memory::needs;
use spectral_tv::mesh::TriangleMesh;

use crate::arrays;
use crate::error::Failure;
use crate::job::guarded;
use crate::pickling::{Parts, Pickled, Reduced, Writer, reduced};

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
    fn new(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        triangles: &Bound<'_, PyAny>,
    ) -> Result<Self, Failure> {
        let vertices = arrays::positions("vertices", vertices)?;
        let triangles = arrays::index_triples("triangles", triangles)?;
        let mesh = guarded(py, |stage| {
            let (v, f) = (vertices.len(), triangles.len());
            let what = format!("a mesh of {v} vertices and {f} triangles");
            stage.claim(needs::mesh(v, f), &what, "take a smaller one")?;
            TriangleMesh::new(vertices, &triangles)
        })?;
        Ok(Self {
            inner: Arc::new(mesh),
        })
    }

    /// Positions, (V, 3); a copy.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
        arrays::rows(py, self.inner.vertices().iter().copied())
    }

    /// Corners of the triangles, (F, 3) int64; a copy.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray2<i64>>, Failure> {
        let triangles = self.inner.triangles().iter();
        arrays::rows(py, triangles.map(|corners| corners.map(i64::from)))
    }

    /// Area of the surface, length².
    #[getter]
    fn area(&self) -> f64 {
        self.inner.area()
    }

    /// Area of each triangle, (F,), length².
    #[getter]
    fn face_areas<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
        arrays::array_of(py, self.inner.face_areas())
    }

    /// A third of the area of each vertex's triangles, (V,), length²; 0 in no triangle.
    #[getter]
    fn vertex_areas<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
        arrays::array_of(py, self.inner.vertex_areas())
    }

    fn __repr__(&self) -> String {
        format!(
            "Mesh({} vertices, {} triangles, area {:.5e})",
            self.inner.vertex_count(),
            self.inner.triangles().len(),
            self.inner.area()
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> Result<Reduced<'py>, Failure> {
        reduced(py, self)
    }

    /// The mesh itself: nothing can change it.
    fn __copy__(mesh: Bound<'_, Self>) -> Bound<'_, Self> {
        mesh
    }

    /// The mesh itself.
    fn __deepcopy__<'py>(mesh: Bound<'py, Self>, _memo: &Bound<'py, PyAny>) -> Bound<'py, Self> {
        mesh
    }
}

impl Pickled for Mesh {
    const NAME: &'static str = "Mesh";

    fn write(&self, parts: &Writer<'_>) -> Result<(), Failure> {
        let py = parts.py();
        let vertices = arrays::rows(py, self.inner.vertices().iter().copied())?;
        parts.value("vertices", vertices)?;
        let triangles = arrays::rows(py, self.inner.triangles().iter().copied())?;
        parts.value("triangles", triangles)
    }

    fn read(py: Python<'_>, parts: &Parts<'_>) -> Result<Self, Failure> {
        Self::new(py, &parts.get("vertices")?, &parts.get("triangles")?)
    }
}
