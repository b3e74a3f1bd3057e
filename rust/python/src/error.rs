//! The exceptions of the package.

use pyo3::PyErr;
use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyRuntimeError, PyValueError};
use spectral_tv::Error;

create_exception!(
    spectral_tv,
    MeshError,
    PyValueError,
    "A mesh, an array or a parameter cannot be used; the message says what is wrong and where."
);
create_exception!(
    spectral_tv,
    Cancelled,
    PyException,
    "The job was cancelled before it finished."
);

/// An [`Error`] of the mathematics on its way to Python; bindings use `?` with it.
pub struct Failure(PyErr);

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        let message = error.to_string();
        Self(match error {
            Error::Cancelled => Cancelled::new_err(message),
            Error::Solver(_) => PyRuntimeError::new_err(message),
            _ => MeshError::new_err(message),
        })
    }
}

impl From<PyErr> for Failure {
    fn from(error: PyErr) -> Self {
        Self(error)
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        failure.0
    }
}
