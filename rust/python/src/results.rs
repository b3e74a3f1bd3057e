//! Results that hold numbers and arrays alone: makes objects of the package's own classes.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use pyo3::{IntoPyObject, IntoPyObjectExt};

/// The fields of a result by their names.
pub struct Fields<'py>(Bound<'py, PyDict>);

impl<'py> Fields<'py> {
    pub fn new(py: Python<'py>) -> Self {
        Self(PyDict::new(py))
    }

    /// Adds a field.
    pub fn with(self, name: &str, value: impl IntoPyObject<'py>) -> PyResult<Self> {
        let value = value.into_bound_py_any(self.0.py())?;
        self.0.set_item(name, value)?;
        Ok(self)
    }

    /// The result of a class in `spectral_tv._results`.
    pub fn made(self, class: &str) -> PyResult<Bound<'py, PyAny>> {
        let module = self.0.py().import("spectral_tv._results")?;
        module.getattr(class)?.call((), Some(&self.0))
    }
}
