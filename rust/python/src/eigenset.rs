//! The class `EigensetTest` and the functions that test a set.

use std::sync::Arc;

use numpy::PyArray1;
use pyo3::prelude::*;
use spectral_tv::eigenset;

use crate::arrays;
use crate::error::{Failure, refused};
use crate::job::{Convert, Job, Task};
use crate::mesh::Mesh;
use crate::pickling::{Parts, Pickled, Reduced, Writer, reduced};

/// What a set C of vertices looks like as an eigenset, found by `eigenset_test`.
#[pyclass(frozen, module = "spectral_tv")]
pub struct EigensetTest {
    inner: eigenset::EigensetTest,
}

#[pymethods]
impl EigensetTest {
    /// |C|, length².
    #[getter]
    fn area(&self) -> f64 {
        self.inner.area
    }

    /// per(C), length: measured by diffusion over two to four edges, so that it does not follow
    /// the triangles, or along them where that is shorter. Narrower sets are measured too short.
    #[getter]
    fn perimeter(&self) -> f64 {
        self.inner.perimeter
    }

    /// λ = per(C)/|C|, 1/length.
    #[getter]
    fn eigenvalue(&self) -> f64 {
        self.inner.eigenvalue()
    }

    /// How fast the value on C falls under the exact flow: what λ is found to be, 1/length.
    #[getter]
    fn rate(&self) -> f64 {
        self.inner.rate
    }

    /// R² of that fall as a straight line, down to extinction.
    #[getter]
    fn straightness(&self) -> f64 {
        self.inner.straightness
    }

    /// The largest distance of the flow from having one value on C and one off it, relative to
    /// its norm, until it is down to 0.3. Some 0.15 where the boundary runs across triangles.
    #[getter]
    fn spread(&self) -> f64 {
        self.inner.spread
    }

    /// Times of the flow, (N+1,), length.
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
        arrays::array_of(py, &self.inner.times)
    }

    /// The mean on C of ψ = 1 on C, −|C|/|M∖C| off it, at these times, (N+1,): max(1 − λt, 0) for
    /// an eigenset.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>, Failure> {
        arrays::array_of(py, &self.inner.values)
    }

    /// The least per(D)/|M∖D| over the supersets D of C that were tried, relative to
    /// per(C)/|M∖C|. An eigenset's is not below 1, but for discretization.
    #[getter]
    fn perimeter_ratio(&self) -> f64 {
        self.inner.perimeter_ratio
    }

    /// The superset that has this ratio, (V,) bool.
    #[getter]
    fn superset<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<bool>>, Failure> {
        arrays::array_of(py, &self.inner.superset)
    }

    /// Whether C is a locally minimal perimeter set as far as was tried: the ratio is at least
    /// 0.98.
    #[getter]
    fn minimal_perimeter(&self) -> bool {
        self.inner.has_minimal_perimeter()
    }

    /// Whether all of it speaks for an eigenset: a minimal perimeter, a straightness of at least
    /// 0.999, a rate within 15 % of the eigenvalue, a spread of at most 0.2.
    #[getter]
    fn is_eigenset(&self) -> bool {
        self.inner.is_eigenset()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> Result<Reduced<'py>, Failure> {
        reduced(py, self)
    }

    /// The result itself: nothing can change it.
    fn __copy__(this: Bound<'_, Self>) -> Bound<'_, Self> {
        this
    }

    /// The result itself.
    fn __deepcopy__<'py>(this: Bound<'py, Self>, _memo: &Bound<'py, PyAny>) -> Bound<'py, Self> {
        this
    }

    fn __repr__(&self) -> String {
        format!(
            "EigensetTest(eigenvalue {:.5e}, rate {:.5e}, straightness {:.5}, spread {:.3}, \
             perimeter ratio {:.3})",
            self.inner.eigenvalue(),
            self.inner.rate,
            self.inner.straightness,
            self.inner.spread,
            self.inner.perimeter_ratio
        )
    }
}

impl Pickled for EigensetTest {
    const NAME: &'static str = "EigensetTest";

    fn write(&self, parts: &Writer<'_>) -> Result<(), Failure> {
        parts.value("area", self.inner.area)?;
        parts.value("perimeter", self.inner.perimeter)?;
        parts.value("rate", self.inner.rate)?;
        parts.value("straightness", self.inner.straightness)?;
        parts.value("spread", self.inner.spread)?;
        parts.list("times", &self.inner.times)?;
        parts.list("values", &self.inner.values)?;
        parts.value("perimeter_ratio", self.inner.perimeter_ratio)?;
        parts.list("superset", &self.inner.superset)
    }

    fn read(_py: Python<'_>, parts: &Parts<'_>) -> Result<Self, Failure> {
        let inner = eigenset::EigensetTest {
            area: parts.value("area")?,
            perimeter: parts.value("perimeter")?,
            rate: parts.value("rate")?,
            straightness: parts.value("straightness")?,
            spread: parts.value("spread")?,
            times: parts.list("times")?,
            values: parts.list("values")?,
            perimeter_ratio: parts.value("perimeter_ratio")?,
            superset: arrays::truth("superset", &parts.get("superset")?)?,
        };
        match inner.times.len() == inner.values.len() {
            true => Ok(Self { inner }),
            false => Err(refused("there must be a value at each time")),
        }
    }
}

/// Test whether a set of vertices is an eigenset of NETV: whether its indicator, up to a constant,
/// is an eigenfunction, which fades in a straight line (Brokman et al. 2024).
///
/// Three things are tested: that the function keeps one value on the set and one off it under the
/// exact flow, that the first falls at the rate λ = per/area in a straight line, and that no set
/// around it has a smaller perimeter, in relation to what it leaves out of the surface. Those sets
/// are samples: a set that passes may still have one.
///
/// Parameters
/// ----------
/// mesh : Mesh
///     Components wholly in the set or wholly outside are left out.
/// members : (V,) array of bools or of floats, or (K,) array of integers
///     The set: True or 0.5 and more for its vertices; or their indices, each once. Integers that
///     are 0 or 1 at every vertex are taken as truth values.
/// progress : callable, optional
///     Called with the fraction done; an exception it raises ends the work.
///
/// Returns
/// -------
/// EigensetTest
///
/// Raises
/// ------
/// MeshError
///     If the members are not of this mesh, or name one vertex twice, or the set has no boundary.
#[pyfunction]
#[pyo3(signature = (mesh, members, progress = None))]
pub fn eigenset_test(
    py: Python<'_>,
    mesh: &Mesh,
    members: &Bound<'_, PyAny>,
    progress: Option<&Bound<'_, PyAny>>,
) -> Result<EigensetTest, Failure> {
    start(mesh, members, |inner| EigensetTest { inner })?.wait(py, progress)
}

/// Start `eigenset_test` in a thread of its own and return the `Job` at once.
#[pyfunction]
pub fn start_eigenset_test(mesh: &Mesh, members: &Bound<'_, PyAny>) -> Result<Job, Failure> {
    let task = start(mesh, members, |inner| -> Convert {
        Box::new(move |py| Ok(Py::new(py, EigensetTest { inner })?.into_any()))
    })?;
    Ok(Job::new(task))
}

fn start<T: Send + 'static>(
    mesh: &Mesh,
    members: &Bound<'_, PyAny>,
    wrap: impl FnOnce(eigenset::EigensetTest) -> T + Send + 'static,
) -> Result<Task<T>, Failure> {
    let set = arrays::set("members", members, mesh.inner.vertex_count())?;
    let mesh = Arc::clone(&mesh.inner);
    Task::start(move |monitor| eigenset::eigenset_test(&mesh, &set, monitor.whole()).map(wrap))
}
