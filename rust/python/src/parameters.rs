//! Numbers from Python as arguments: a refusal names the argument and what it was given.

use pyo3::exceptions::{PyOverflowError, PyTypeError};
use pyo3::prelude::*;

use crate::error::MeshError;

/// A type of number that an argument can have.
pub trait Number: Sized {
    /// Reads the argument `name`.
    ///
    /// # Errors
    /// `TypeError` if it is no such number, `MeshError` if it is out of the type's range.
    fn read(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Self>;
}

/// Functions that read the arguments they are named after, for `from_py_with`.
macro_rules! named {
    ($($name:ident)*) => {
        $(
            pub fn $name<T: Number>(value: &Bound<'_, PyAny>) -> PyResult<T> {
                T::read(stringify!($name), value)
            }
        )*
    };
}

named! {
    band bands count farthest finest gain height joint_softness keep_limbs largest refinement scales seed
    segments smooth softness steps stiffness stillness stretch time tolerance
}

macro_rules! integers {
    ($($type:ty)*) => {
        $(
            impl Number for $type {
                fn read(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
                    let must = || format!("must be an integer from 0 to {}", Self::MAX);
                    value.extract().map_err(|error| refusal(name, must, value, error))
                }
            }
        )*
    };
}

integers!(usize u32 u64);

impl Number for f64 {
    fn read(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        let must = || "must be a number, at most 1e308 in size".to_owned();
        value
            .extract()
            .map_err(|error| refusal(name, must, value, error))
    }
}

impl Number for (f64, f64) {
    fn read(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        let must = || "must be two numbers".to_owned();
        let refuse = |error| refusal(name, must, value, error);
        let [first, second] = value.extract::<[Bound<'_, PyAny>; 2]>().map_err(refuse)?;
        let part = |index: usize, part| f64::read(&format!("{name}[{index}]"), part);
        Ok((part(0, &first)?, part(1, &second)?))
    }
}

impl<T: Number> Number for Option<T> {
    fn read(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        match value.is_none() {
            true => Ok(None),
            false => T::read(name, value).map(Some),
        }
    }
}

/// What to raise for a value that could not be read.
fn refusal(name: &str, must: impl Fn() -> String, value: &Bound<'_, PyAny>, error: PyErr) -> PyErr {
    let py = value.py();
    let message = format!("{name} {}, not {}", must(), shown(value));
    let refusal = match error.is_instance_of::<PyOverflowError>(py) {
        true => MeshError::new_err(message),
        false => PyTypeError::new_err(message),
    };
    refusal.set_cause(py, Some(error));
    refusal
}

/// A value as Python writes it, cut where it is long.
fn shown(value: &Bound<'_, PyAny>) -> String {
    const LONGEST: usize = 60;
    // An integer of thousands of digits is not written at all.
    let Ok(text) = value.repr() else {
        return "one of its size".into();
    };
    let text = text.to_string();
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{} …", &text[..end]),
        None => text,
    }
}
