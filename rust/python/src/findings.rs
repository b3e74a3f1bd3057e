//! The class `Findings`.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use spectral_tv::mesh;

use crate::error::Failure;
use crate::pickling::{Parts, Pickled, Reduced, Writer, reduced};

/// Counts of what was found in a mesh, and done about it; `Mesh.findings` are those of one.
///
/// They are true if anything was done; as a string they say what, in one line.
#[pyclass(frozen, eq, module = "spectral_tv")]
#[derive(PartialEq)]
pub struct Findings {
    pub inner: mesh::Findings,
}

#[pymethods]
impl Findings {
    /// Vertices on open edges, which belong to one triangle only, as they were handed in.
    #[getter]
    fn border_corners(&self) -> usize {
        self.inner.border_corners
    }

    /// Those of them that were joined to another.
    #[getter]
    fn joined_corners(&self) -> usize {
        self.inner.joined_corners
    }

    /// Corners at which an open edge was split, each edge counted: T-junctions.
    #[getter]
    fn closed_junctions(&self) -> usize {
        self.inner.closed_junctions
    }

    /// Vertices that are not finite and were dropped.
    #[getter]
    fn dropped_vertices(&self) -> usize {
        self.inner.dropped_vertices
    }

    /// Triangles that were dropped with them.
    #[getter]
    fn dropped_triangles(&self) -> usize {
        self.inner.dropped_triangles
    }

    /// Edges of one triangle only, as they were handed in.
    #[getter]
    fn open_edges_before(&self) -> usize {
        self.inner.open_edges_before
    }

    /// Edges of one triangle only, in the mesh.
    #[getter]
    fn open_edges(&self) -> usize {
        self.inner.open_edges
    }

    /// Connected components of the mesh, without vertices in no triangle.
    #[getter]
    fn components(&self) -> usize {
        self.inner.components
    }

    /// All counts by their names.
    fn as_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let counts = PyDict::new(py);
        for (name, count) in self.inner.counts() {
            counts.set_item(name, count)?;
        }
        Ok(counts)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> Result<Reduced<'py>, Failure> {
        reduced(py, self)
    }

    /// The findings themselves: nothing can change them.
    fn __copy__(this: Bound<'_, Self>) -> Bound<'_, Self> {
        this
    }

    /// The findings themselves.
    fn __deepcopy__<'py>(this: Bound<'py, Self>, _memo: &Bound<'py, PyAny>) -> Bound<'py, Self> {
        this
    }

    fn __bool__(&self) -> bool {
        self.inner.is_repaired()
    }

    fn __str__(&self) -> String {
        self.inner.to_string()
    }

    fn __repr__(&self) -> String {
        let counts = self.inner.counts();
        let counts = counts.map(|(name, count)| format!("{name}={count}"));
        format!("Findings({})", counts.join(", "))
    }
}

impl Pickled for Findings {
    const NAME: &'static str = "Findings";

    fn write(&self, parts: &Writer<'_>) -> Result<(), Failure> {
        let mut counts = self.inner.counts().into_iter();
        counts.try_for_each(|(name, count)| parts.value(name, count))
    }

    fn read(_py: Python<'_>, parts: &Parts<'_>) -> Result<Self, Failure> {
        Ok(Self {
            inner: mesh::Findings {
                border_corners: parts.value("border_corners")?,
                joined_corners: parts.value("joined_corners")?,
                closed_junctions: parts.value("closed_junctions")?,
                dropped_vertices: parts.value("dropped_vertices")?,
                dropped_triangles: parts.value("dropped_triangles")?,
                open_edges_before: parts.value("open_edges_before")?,
                open_edges: parts.value("open_edges")?,
                components: parts.value("components")?,
            },
        })
    }
}
