//! The class `Nearest`.

use std::sync::Arc;

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use spectral_tv::mesh::TriangleMesh;
use spectral_tv::nearest;

use crate::arrays;
use crate::error::{Failure, MeshError};
use crate::job::guarded;
use crate::mesh::{Mesh, claim};
use crate::parameters;

/// Faces (N,), −1 where there is none; the shares of their corners (N, 3); and distances (N,).
type Places<'py> = (
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<f64>>,
);

/// The surface of a mesh in which nearest points are looked for.
#[pyclass(frozen, module = "spectral_tv._native")]
pub struct Nearest {
    inner: nearest::Nearest,
}

#[pymethods]
impl Nearest {
    #[new]
    fn new(py: Python<'_>, mesh: &Mesh) -> Result<Self, Failure> {
        let mesh = Arc::clone(&mesh.inner);
        let inner = guarded(py, |stage| nearest::Nearest::new_with(&mesh, stage))?;
        Ok(Self { inner })
    }

    /// The surface of vertices and triangles, of which no warning tells what is doubtful.
    #[staticmethod]
    fn of(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        triangles: &Bound<'_, PyAny>,
    ) -> Result<Self, Failure> {
        let vertices = arrays::positions("vertices", vertices)?;
        let triangles = arrays::index_triples("triangles", triangles)?;
        let inner = guarded(py, |stage| {
            claim(stage, vertices.len(), triangles.len(), None)?;
            let mesh = Arc::new(TriangleMesh::new(vertices, &triangles)?);
            nearest::Nearest::new_with(&mesh, stage)
        })?;
        Ok(Self { inner })
    }

    /// The nearest places no farther than a length from points, in triangles that face as the normals
    /// do; a normal of 0 allows all.
    fn find<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        normals: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = parameters::farthest)] farthest: f64,
    ) -> Result<Places<'py>, Failure> {
        let points = arrays::positions("points", points)?;
        let normals = arrays::positions("normals", normals)?;
        if normals.len() != points.len() {
            return Err(MeshError::new_err("every point needs its normal").into());
        }
        if farthest.is_nan() || farthest < 0.0 {
            return Err(MeshError::new_err("farthest must be a length, at least 0").into());
        }
        let is_finite = |rows: &[[f64; 3]]| rows.as_flattened().iter().all(|x| x.is_finite());
        if !is_finite(&points) || !is_finite(&normals) {
            return Err(MeshError::new_err("points and normals must be finite").into());
        }
        let found = guarded(py, |stage| {
            self.inner.all_facing(&points, &normals, farthest, stage)
        })?;
        let faces = found
            .iter()
            .map(|place| place.map_or(-1, |place| place.face as i64));
        let weights = found
            .iter()
            .map(|place| place.map_or([0.0; 3], |place| place.weights));
        let distances = found
            .iter()
            .map(|place| place.map_or(f64::INFINITY, |place| place.distance));
        Ok((
            arrays::collected(py, faces)?,
            arrays::rows(py, weights)?,
            arrays::collected(py, distances)?,
        ))
    }
}
