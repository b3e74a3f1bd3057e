//! The exceptions of the package.

use numpy::{IntoPyArray, PyArray1};
use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyMemoryError, PyRuntimeError, PyUserWarning, PyValueError};
use pyo3::prelude::*;
use spectral_tv::{ArgumentError, Error};

create_exception!(
    spectral_tv,
    MeshError,
    PyValueError,
    "A mesh, an array or a parameter cannot be used; the message says what is wrong and where.\n\n\
     `vertices` and `faces`, (n,) int64 arrays, are the indices of all elements that are at fault,\n\
     empty where it is not theirs."
);
create_exception!(
    spectral_tv,
    Cancelled,
    PyException,
    "The job was cancelled before it finished."
);

create_exception!(
    spectral_tv,
    MeshWarning,
    PyUserWarning,
    "Something about a mesh is probably a mistake, or something of it was left out."
);

/// An [`Error`] of the mathematics on its way to Python; bindings use `?` with it.
pub struct Failure(PyErr);

/// What the library calls an argument, and what the package does.
const NAMES: [(&str, &str); 2] = [("duration", "time"), ("set", "members")];

/// The refusal of an argument that only the package knows.
pub fn refused(message: impl Into<String>) -> Failure {
    Failure(MeshError::new_err(message.into()))
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        let error = match error {
            Error::Argument(argument) => Error::Argument(renamed(argument)),
            error => error,
        };
        let message = error.to_string();
        Self(match &error {
            Error::Cancelled => Cancelled::new_err(message),
            Error::Memory(_) => PyMemoryError::new_err(message),
            Error::Solver(_) => PyRuntimeError::new_err(message),
            _ => mesh_error(&error),
        })
    }
}

/// The error, with the package's name of the argument.
fn renamed(error: ArgumentError) -> ArgumentError {
    let name = NAMES.iter().find(|(name, _)| *name == error.argument);
    match name {
        Some(&(_, argument)) => ArgumentError {
            argument: argument.into(),
            ..error
        },
        None => error,
    }
}

/// The exception of an error that may concern elements of the mesh, which it then names.
fn mesh_error(error: &Error) -> PyErr {
    let exception = MeshError::new_err(error.to_string());
    Python::attach(|py| {
        let name_elements = |attribute: &str, elements: &[usize]| match elements {
            [] => Ok(()),
            _ => exception
                .value(py)
                .setattr(attribute, indices(py, elements)),
        };
        // An exception takes any attribute; if it did not, its message would still tell.
        let _ = name_elements("vertices", error.vertices());
        let _ = name_elements("faces", error.triangles());
    });
    exception
}

/// Gives the class the attributes that its exceptions have where no element is at fault.
pub fn prepare(py: Python<'_>) -> PyResult<()> {
    let class = py.get_type::<MeshError>();
    class.setattr("vertices", NoElements)?;
    class.setattr("faces", NoElements)
}

/// An empty array, made when it is asked for: the first array makes Python read NumPy.
#[pyclass(frozen)]
struct NoElements;

#[pymethods]
impl NoElements {
    fn __get__<'py>(
        &self,
        _exception: &Bound<'py, PyAny>,
        class: &Bound<'py, PyAny>,
    ) -> Bound<'py, PyArray1<i64>> {
        indices(class.py(), &[])
    }
}

fn indices<'py>(py: Python<'py>, elements: &[usize]) -> Bound<'py, PyArray1<i64>> {
    let indices: Vec<_> = elements.iter().map(|&index| index as i64).collect();
    indices.into_pyarray(py)
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
