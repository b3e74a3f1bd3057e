//! The class `Mesh`.

use std::sync::Arc;

use std::ffi::CString;

use numpy::{IntoPyArray, PyArray1, PyArray2};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyBool;
use spectral_tv::Error;
use spectral_tv::mesh::{Broken, Repair, TriangleMesh};
use spectral_tv::operators::positions;

use crate::arrays;
use crate::error::{Failure, MeshWarning};
use crate::findings::Findings;
use crate::job::guarded;
use crate::parameters::Number;

/// A triangle mesh with N vertices, checked once.
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
/// weld : float, optional
///     A length: surfaces are joined along open edges, which belong to one triangle only, that are
///     within it of one another. Corners there become one, at their mean, and an edge is split
///     at the corners of other edges that lie on it, which adds triangles. 0 joins what is at exactly
///     the same place alone. However long `weld` is, a corner reaches no farther than a quarter of its
///     shortest edge, so that no edge collapses. Without it all vertices stay as they are.
/// broken : {"refuse", "drop"}
///     What becomes of vertices that are not finite, or beyond 1e100: the mesh is refused, or they
///     are dropped with all their triangles, with a warning.
///
/// Raises
/// ------
/// MeshError
///     Names the first vertex that is not finite or triangle whose index is out of range; or
///     says that the mesh has no triangles or spans no area.
///
/// Warns
/// -----
/// MeshWarning
///     If vertices were dropped; and of what is probably a mistake: triangles that are not joined,
///     borders that lie on one another or nearly so, to 1e-5 of the size, and are not welded;
///     triangles that are there twice; vertices most of which are in no triangle.
#[pyclass(frozen, module = "spectral_tv")]
pub struct Mesh {
    pub inner: Arc<TriangleMesh>,
}

#[pymethods]
impl Mesh {
    #[new]
    #[pyo3(signature = (vertices, triangles, weld = None, broken = "refuse"))]
    fn new(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        triangles: &Bound<'_, PyAny>,
        weld: Option<Bound<'_, PyAny>>,
        broken: &str,
    ) -> Result<Self, Failure> {
        let repair = Repair {
            weld: weld.as_ref().map(length).transpose()?,
            broken: what_becomes_of_broken(broken)?,
        };
        let vertices = arrays::positions("vertices", vertices)?;
        let triangles = arrays::index_triples("triangles", triangles)?;
        let (mesh, doubts) = guarded(py, || {
            let mesh = TriangleMesh::repaired(vertices, &triangles, &repair)?;
            let doubts = mesh.doubts(repair.weld);
            Ok((mesh, doubts))
        })?;
        if matches!(mesh.weld_map(), Some(map) if map.contains(&None)) {
            warn(py, &mesh.findings().dropped())?;
        }
        for doubt in doubts {
            warn(py, &doubt.to_string())?;
        }
        Ok(Self {
            inner: Arc::new(mesh),
        })
    }

    /// Positions, (N, 3); a copy.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        arrays::per_vertex(py, &positions(&self.inner))
    }

    /// Corners of the triangles, (F, 3) int64; a copy. Triangles that were split are shorter, and
    /// their other parts are behind all others.
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

    /// A third of the area of each vertex's triangles, (N,), length²; 0 in no triangle.
    #[getter]
    fn vertex_areas<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.inner.vertex_areas().to_vec().into_pyarray(py)
    }

    /// Which of the N vertices each of those handed in is now, (V,) int64; -1 for one that was
    /// dropped. `values[mesh.weld_map]` are the values of all of them, where none is -1.
    #[getter]
    fn weld_map<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        let map: Vec<i64> = match self.inner.weld_map() {
            Some(map) => map
                .iter()
                .map(|place| place.map_or(-1, i64::from))
                .collect(),
            None => (0..self.inner.vertex_count() as i64).collect(),
        };
        map.into_pyarray(py)
    }

    /// What was found in the mesh, and done about it.
    #[getter]
    fn findings(&self, py: Python<'_>) -> Findings {
        Findings {
            inner: py.detach(|| *self.inner.findings()),
        }
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

/// The argument `weld`.
fn length(weld: &Bound<'_, PyAny>) -> PyResult<f64> {
    if weld.is_instance_of::<PyBool>() {
        let message = format!("weld must be a length, not {weld}: 0.0 joins what is at one place");
        return Err(PyTypeError::new_err(message));
    }
    f64::read("weld", weld)
}

/// The argument `broken`.
fn what_becomes_of_broken(broken: &str) -> Result<Broken, Error> {
    match broken {
        "refuse" => Ok(Broken::Refuse),
        "drop" => Ok(Broken::Drop),
        _ => Err(Error::Argument(format!(
            "broken must be \"refuse\" or \"drop\", not \"{broken}\""
        ))),
    }
}

/// Warns whoever called.
fn warn(py: Python<'_>, message: &str) -> PyResult<()> {
    let message = CString::new(message).expect("messages have no 0 in them");
    PyErr::warn(py, &py.get_type::<MeshWarning>(), &message, 1)
}
