//! Pickles: each object as named arrays and numbers, and back.
//!
//! What is read is checked like any other input, by the library's own constructors. So no pickle,
//! whatever its origin, gives an object that the library itself would refuse to make.

use ndarray::{Array2, ArrayView2};
use numpy::Element;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays;
use crate::decomposition::Decomposition;
use crate::deformer::Deformer;
use crate::error::{Failure, MeshError, refused};
use crate::flow::Flow;
use crate::mesh::Mesh;
use crate::poser::Poser;

/// To be counted up where what is written changes.
const FORMAT: u32 = 4;

type Reduced<'py> = (
    Bound<'py, PyAny>,
    (&'static str, u32, &'static str, Bound<'py, PyDict>),
);

/// An object that is written as named arrays and numbers, and made of them again.
pub trait Pickled: Sized {
    /// The name of its class.
    const NAME: &'static str;

    /// Writes the parts.
    fn write(&self, parts: &Writer<'_>) -> Result<(), Failure>;

    /// Makes one of them.
    fn read(py: Python<'_>, parts: &Parts<'_>) -> Result<Self, Failure>;
}

/// The classes whose objects are pickled.
macro_rules! pickled {
    ($($class:ident),+) => {
        /// What pickles an object, as `__reduce__` returns it: a function, and its arguments.
        #[pyfunction]
        pub fn _reduced<'py>(object: &Bound<'py, PyAny>) -> Result<Reduced<'py>, Failure> {
            $(if let Ok(object) = object.cast::<$class>() {
                return reduced(object.py(), object.get());
            })+
            let class = object.get_type().name()?;
            Err(refused(format!("spectral_tv pickles no {class}")))
        }

        fn restored<'py>(class: &str, parts: Bound<'py, PyDict>) -> Result<Bound<'py, PyAny>, Failure> {
            let py = parts.py();
            match class {
                $($class::NAME => {
                    let class = $class::NAME;
                    Ok($class::read(py, &Parts { class, parts })?.into_bound_py_any(py)?)
                })+
                other => Err(refused(format!("spectral_tv pickles no {other:?}"))),
            }
        }
    };
}

pickled!(Decomposition, Deformer, Flow, Mesh, Poser);

fn reduced<'py, T: Pickled>(py: Python<'py>, object: &T) -> Result<Reduced<'py>, Failure> {
    let parts = Writer(PyDict::new(py));
    object.write(&parts)?;
    let restore = py.import("spectral_tv._native")?.getattr("_restore")?;
    let version = env!("CARGO_PKG_VERSION");
    Ok((restore, (T::NAME, FORMAT, version, parts.0)))
}

/// The parts of an object that is pickled.
pub struct Writer<'py>(Bound<'py, PyDict>);

impl<'py> Writer<'py> {
    pub fn py(&self) -> Python<'py> {
        self.0.py()
    }

    /// Anything that can be pickled by itself.
    pub fn value(&self, name: &str, value: impl IntoPyObject<'py>) -> Result<(), Failure> {
        let value = value.into_bound_py_any(self.py())?;
        Ok(self.0.set_item(name, value)?)
    }

    /// A list of numbers or truth values.
    pub fn list<T: Element + Copy>(&self, name: &str, values: &[T]) -> Result<(), Failure> {
        self.value(name, arrays::array_of(self.py(), values)?)
    }

    /// Rows of numbers.
    pub fn matrix<T: Element + Copy>(
        &self,
        name: &str,
        values: ArrayView2<T>,
    ) -> Result<(), Failure> {
        self.value(name, arrays::table_of(self.py(), values)?)
    }
}

/// The parts of an object that was pickled.
pub struct Parts<'py> {
    class: &'static str,
    parts: Bound<'py, PyDict>,
}

impl<'py> Parts<'py> {
    /// The part of a name; `None` for one that is None.
    pub fn optional(&self, name: &str) -> Result<Option<Bound<'py, PyAny>>, Failure> {
        let found = self.parts.get_item(name)?.ok_or_else(|| {
            let class = self.class;
            MeshError::new_err(format!("the pickle of a {class} has no part {name:?}"))
        })?;
        Ok(Some(found).filter(|found| !found.is_none()))
    }

    pub fn get(&self, name: &str) -> Result<Bound<'py, PyAny>, Failure> {
        let found = self.optional(name)?;
        Ok(found.ok_or_else(|| MeshError::new_err(format!("{name} must not be None")))?)
    }

    /// A number, or whatever else has this type.
    pub fn value<T: for<'a> FromPyObject<'a, 'py>>(&self, name: &str) -> Result<T, Failure> {
        let value = self.get(name)?;
        Ok(value.extract::<T>().map_err(Into::<PyErr>::into)?)
    }

    pub fn list(&self, name: &str) -> Result<Vec<f64>, Failure> {
        arrays::list(name, &self.get(name)?)
    }

    pub fn indices(&self, name: &str) -> Result<Vec<i64>, Failure> {
        arrays::indices(name, &self.get(name)?)
    }

    pub fn matrix(&self, name: &str) -> Result<Array2<f64>, Failure> {
        arrays::matrix(name, &self.get(name)?, "float64")
    }
}

/// The object of a class that was pickled in a format, by a version of the package, with its parts.
#[pyfunction]
pub fn _restore<'py>(
    class: &str,
    format: u32,
    version: &str,
    parts: Bound<'py, PyDict>,
) -> Result<Bound<'py, PyAny>, Failure> {
    if format != FORMAT {
        return Err(MeshError::new_err(format!(
            "this {class} was pickled by spectral_tv {version} in format {format}, but spectral_tv \
             {} reads format {FORMAT} only; make it anew, or read it with that version",
            env!("CARGO_PKG_VERSION")
        ))
        .into());
    }
    restored(class, parts)
}
