//! The class `Mesh`.

use std::collections::BTreeMap;
use std::ffi::CString;
use std::sync::Arc;

use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyBool;
use spectral_tv::Named;
use spectral_tv::memory::needs;
use spectral_tv::mesh::{self, Broken, Findings, Repair, TriangleMesh};
use spectral_tv::monitor::Stage;

use crate::arrays;
use crate::error::{Failure, MeshWarning, refused};
use crate::job::guarded;
use crate::parameters::Number;
use crate::pickling::{Parts, Pickled, Writer};
use crate::results::Fields;

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
///     A length. Surfaces are joined along open edges, those of one triangle only, that are within
///     this length of one another. Corners there become one, at their mean. An edge is split at
///     the corners of other edges that lie on it, which adds triangles. 0 joins only what is at
///     exactly the same place. However long `weld` is, a corner reaches no farther than a quarter
///     of its shortest edge, so that no edge collapses. By default all vertices stay as they are.
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
///     If vertices were dropped, or if something is probably a mistake: triangles that are not
///     joined; borders that lie on one another or nearly so, to 1e-5 of the size, and are not
///     welded; triangles that are there twice; a mesh most of whose vertices are in no triangle.
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
            broken: Broken::named(broken)?,
        };
        let vertices = arrays::positions("vertices", vertices)?;
        let triangles = arrays::index_triples("triangles", triangles)?;
        let (mesh, dropped, doubts) = guarded(py, |stage| {
            claim(stage, vertices.len(), triangles.len(), repair.weld)?;
            let mesh = TriangleMesh::repaired(vertices, &triangles, &repair)?;
            let has_dropped = matches!(mesh.weld_map(), Some(map) if map.contains(&None));
            let dropped = has_dropped.then(|| mesh.findings().dropped());
            let doubts = mesh.doubts(repair.weld);
            Ok((mesh, dropped, doubts))
        })?;
        if let Some(dropped) = dropped {
            warn(py, &dropped)?;
        }
        for doubt in doubts {
            warn(py, &with_keyword(&doubt.to_string()))?;
        }
        Ok(Self {
            inner: Arc::new(mesh),
        })
    }

    /// The mesh of a surface of another library.
    ///
    /// Parameters
    /// ----------
    /// surface : object
    ///     A `trimesh.Trimesh`, `meshio.Mesh`, `pyvista.PolyData` or Open3D `TriangleMesh`. Polygons are
    ///     split into triangles.
    /// weld, broken
    ///     As `Mesh` takes them.
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     As `Mesh` does, or if the object is of no such class.
    ///
    /// Warns
    /// -----
    /// MeshWarning
    ///     As `Mesh` does, and if something of the object takes no part, as lines.
    #[staticmethod]
    #[pyo3(signature = (surface, weld = None, broken = "refuse"))]
    fn of(
        py: Python<'_>,
        surface: &Bound<'_, PyAny>,
        weld: Option<Bound<'_, PyAny>>,
        broken: &str,
    ) -> Result<Self, Failure> {
        let module = py.import("spectral_tv._surfaces")?;
        let arrays = module.call_method1("arrays_of", (surface,))?;
        let (vertices, triangles): (Bound<'_, PyAny>, Bound<'_, PyAny>) = arrays.extract()?;
        Self::new(py, &vertices, &triangles, weld, broken)
    }

    /// Positions, (N, 3); a copy.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
        arrays::rows(py, self.inner.vertices().iter().copied())
    }

    /// Corners of the triangles, (F, 3) int64; a copy. Triangles that were split are shorter, and
    /// their other parts are behind all others.
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

    /// A third of the area of each vertex's triangles, (N,), length²; 0 in no triangle.
    #[getter]
    fn vertex_areas<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
        arrays::array_of(py, self.inner.vertex_areas())
    }

    /// For each vertex that was handed in, its index among the N vertices of the mesh, (V,) int64;
    /// -1 for one that was dropped. `values[mesh.weld_map]` takes values of the N vertices to the V
    /// that were handed in, if none was dropped.
    #[getter]
    fn weld_map<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<i64>>, Failure> {
        match self.inner.weld_map() {
            Some(map) => {
                let place = |place: &Option<u32>| place.map_or(-1, i64::from);
                arrays::collected(py, map.iter().map(place))
            }
            None => {
                let count = self.inner.vertex_count();
                arrays::collected(py, (0..count).map(|vertex| vertex as i64))
            }
        }
    }

    /// What was found in the mesh, and done about it.
    #[getter]
    fn findings<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyAny>, Failure> {
        let found = self.found(py)?;
        let mut fields = Fields::new(py);
        for (name, count) in found.counts() {
            fields = fields.with(name, count)?;
        }
        Ok(fields.with("told", found.to_string())?.made("Findings")?)
    }

    /// The same mesh with a thickness of the shape that is given. `keep_limbs` and `base="limbs"` go by
    /// it in place of what `thickness` would measure.
    ///
    /// Parameters
    /// ----------
    /// thickness : (N,) array
    ///     Lengths, 0 or more.
    ///
    /// Returns
    /// -------
    /// Mesh
    ///
    /// Raises
    /// ------
    /// MeshError
    ///     If there is not one length per vertex, or one is negative, not finite, or beyond 1e100.
    fn with_thickness(
        &self,
        py: Python<'_>,
        thickness: &Bound<'_, PyAny>,
    ) -> Result<Self, Failure> {
        let thickness = arrays::list("thickness", thickness)?;
        let mesh = guarded(py, |_| self.inner.with_thickness(thickness))?;
        Ok(Self {
            inner: Arc::new(mesh),
        })
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

impl Mesh {
    /// What was found in the mesh, which is looked for when it is first asked for.
    fn found(&self, py: Python<'_>) -> Result<Findings, Failure> {
        guarded(py, |stage| {
            let triangles = self.inner.triangles().len();
            claim(stage, self.inner.vertex_count(), triangles, None)?;
            Ok(*self.inner.findings())
        })
    }
}

impl Pickled for Mesh {
    const NAME: &'static str = "Mesh";

    fn write(&self, parts: &Writer<'_>) -> Result<(), Failure> {
        let py = parts.py();
        let vertices = arrays::rows(py, self.inner.vertices().iter().copied())?;
        parts.value("vertices", vertices)?;
        let triangles = arrays::rows(py, self.inner.triangles().iter().copied())?;
        parts.value("triangles", triangles)?;
        // Where nothing was done, there is nothing to keep of it.
        let is_as_it_was = self.inner.weld_map().is_none();
        let (map, counts) = match is_as_it_was {
            true => (None, None),
            false => {
                let counts: BTreeMap<_, _> = self.found(py)?.counts().into();
                (Some(self.weld_map(py)?), Some(counts))
            }
        };
        parts.value("weld_map", map)?;
        parts.value("findings", counts)?;
        let thickness = self.inner.known_thickness();
        let array = |radii| arrays::array_of(py, radii);
        parts.value("thickness", thickness.map(array).transpose()?)
    }

    fn read(py: Python<'_>, parts: &Parts<'_>) -> Result<Self, Failure> {
        let vertices = arrays::positions("vertices", &parts.get("vertices")?)?;
        let triangles = arrays::index_triples("triangles", &parts.get("triangles")?)?;
        let weld_map = match parts.optional("weld_map")? {
            Some(map) => Some(read_weld_map(&arrays::indices("weld_map", &map)?)?),
            None => None,
        };
        let findings = match parts.optional("findings")? {
            Some(found) => {
                let counts: BTreeMap<String, usize> = found.extract()?;
                Some(mesh::Findings::of_counts(|name| counts.get(name).copied())?)
            }
            None => None,
        };
        let thickness = match parts.optional("thickness")? {
            Some(radii) => Some(arrays::list("thickness", &radii)?),
            None => None,
        };
        let mesh = guarded(py, |stage| {
            claim(stage, vertices.len(), triangles.len(), None)?;
            let mesh = TriangleMesh::from_parts(vertices, &triangles, weld_map, findings)?;
            match thickness {
                Some(radii) => mesh.with_thickness(radii),
                None => Ok(mesh),
            }
        })?;
        Ok(Self {
            inner: Arc::new(mesh),
        })
    }
}

fn read_weld_map(map: &[i64]) -> Result<Vec<Option<u32>>, Failure> {
    let place = |&place: &i64| match place {
        -1 => Ok(None),
        place => u32::try_from(place)
            .map(Some)
            .map_err(|_| refused(format!("weld_map must have places or -1, not {place}"))),
    };
    map.iter().map(place).collect()
}

/// Claims what making a mesh takes, and welding it with a length above 0.
pub fn claim(
    stage: Stage,
    vertices: usize,
    triangles: usize,
    weld: Option<f64>,
) -> spectral_tv::Result<()> {
    let welding = match weld {
        Some(length) if length > 0.0 => needs::welding(vertices),
        _ => 0,
    };
    stage.claim(
        needs::mesh(vertices, triangles).saturating_add(welding),
        &format!("a mesh of {vertices} vertices and {triangles} triangles"),
        "take a smaller one",
    )
}

/// The argument `weld`.
fn length(weld: &Bound<'_, PyAny>) -> PyResult<f64> {
    if weld.is_instance_of::<PyBool>() {
        let message = format!("weld must be a length, not {weld}: 0.0 joins what is at one place");
        return Err(PyTypeError::new_err(message));
    }
    f64::read("weld", weld)
}

/// What the library says of a doubt, with the keyword that cures it.
fn with_keyword(doubt: &str) -> String {
    let doubt = doubt.replace("; weld with a length", "; pass weld=, a length");
    doubt.replace("; weld with ", "; pass weld=")
}

/// Warns whoever called.
fn warn(py: Python<'_>, message: &str) -> PyResult<()> {
    let message = CString::new(message).expect("messages have no 0 in them");
    PyErr::warn(py, &py.get_type::<MeshWarning>(), &message, 1)
}
