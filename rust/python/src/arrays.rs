//! NumPy arrays to the arrays of the mathematics and back.
//!
//! Python has a row per vertex, (V, C); the mathematics a row per channel, (C, V).

use ndarray::{Array2, Array3};
use numpy::{IntoPyArray, PyArray2, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use spectral_tv::monitor::Stage;
use spectral_tv::{Error, memory};

use crate::error::MeshError;

/// Kinds of NumPy dtypes that hold numbers: signed, unsigned and floating.
const NUMBERS: &str = "iuf";
const INTEGERS: &str = "iu";
/// The same and truth values, which count as 0 and 1.
const WEIGHTS: &str = "iufb";

/// Reads an array of numbers of any shape, dtype and layout as float64.
fn numbers<'py>(
    name: &str,
    value: &Bound<'py, PyAny>,
    kinds: &str,
    dtype: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let numpy = value.py().import("numpy")?;
    let refuse = |found: &str| {
        let wanted = if kinds == INTEGERS {
            "integers"
        } else {
            "numbers"
        };
        MeshError::new_err(format!("{name} must be an array of {wanted}, not {found}"))
    };
    let array = numpy
        .call_method1("asarray", (value,))
        .map_err(|error| refuse(&error.to_string()))?;
    let found = array.getattr("dtype")?;
    let kind: String = found.getattr("kind")?.extract()?;
    if !kinds.contains(&kind) {
        return Err(refuse(&format!("of {found}")));
    }
    let options = PyDict::new(value.py());
    options.set_item("dtype", dtype)?;
    options.set_item("order", "C")?;
    array.call_method("astype", (), Some(&options))
}

/// An array of shape (rows, 3) as rows.
fn triples<T: numpy::Element + Copy>(
    name: &str,
    array: &Bound<'_, PyAny>,
) -> PyResult<Vec<[T; 3]>> {
    let array = array.cast::<PyArrayDyn<T>>()?;
    let shape = array.shape();
    if shape.len() != 2 || shape[1] != 3 {
        return Err(MeshError::new_err(format!(
            "{name} must have the shape (rows, 3), not {shape:?}"
        )));
    }
    let read = array.readonly();
    let (rows, _) = read.as_slice()?.as_chunks::<3>();
    Ok(rows.to_vec())
}

/// Positions, (V, 3) numbers.
pub fn positions(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<[f64; 3]>> {
    triples(name, &numbers(name, value, NUMBERS, "float64")?)
}

/// Index triples, (F, 3) integers.
pub fn index_triples(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<[i64; 3]>> {
    triples(name, &numbers(name, value, INTEGERS, "int64")?)
}

/// Values of shape (V,) or (V, C) as (C, V), and whether they had the first shape.
pub fn channels(name: &str, value: &Bound<'_, PyAny>) -> PyResult<(Array2<f64>, bool)> {
    let array = numbers(name, value, NUMBERS, "float64")?;
    let array = array.cast::<PyArrayDyn<f64>>()?;
    let shape = array.shape().to_vec();
    let (rows, count) = match shape[..] {
        [rows] => (rows, 1),
        [rows, count] => (rows, count),
        _ => {
            return Err(MeshError::new_err(format!(
                "{name} must have the shape (V,) or (V, C), not {shape:?}"
            )));
        }
    };
    let read = array.readonly();
    let flat = read.as_slice()?;
    let values = Array2::from_shape_fn((count, rows), |(c, v)| flat[v * count + c]);
    Ok((values, shape.len() == 1))
}

/// Pixels of shape (H, W) or (H, W, C) as (C, H × W), with H and W, and whether there were channels.
pub fn pixels(name: &str, value: &Bound<'_, PyAny>) -> PyResult<(Array2<f64>, [usize; 2], bool)> {
    let array = numbers(name, value, NUMBERS, "float64")?;
    let array = array.cast::<PyArrayDyn<f64>>()?;
    let shape = array.shape().to_vec();
    let (rows, columns, count) = match shape[..] {
        [rows, columns] => (rows, columns, 1),
        [rows, columns, count] if count > 0 => (rows, columns, count),
        _ => {
            return Err(MeshError::new_err(format!(
                "{name} must have the shape (H, W) or (H, W, C), not {shape:?}"
            )));
        }
    };
    let read = array.readonly();
    let flat = read.as_slice()?;
    let values = Array2::from_shape_fn((count, rows * columns), |(c, p)| flat[p * count + c]);
    Ok((values, [rows, columns], shape.len() == 3))
}

/// A list of numbers, (N,).
pub fn list(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    flat(name, &numbers(name, value, NUMBERS, "float64")?)
}

/// A list of numbers or truth values, (N,).
pub fn weights(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    flat(name, &numbers(name, value, WEIGHTS, "float64")?)
}

/// A set of `count` elements: truth values or numbers, from 0.5 on; or integers, its indices.
pub fn set(name: &str, value: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<bool>> {
    if let Ok(indices) = indices(name, value) {
        let mut set = vec![false; count];
        for index in indices {
            let inside = usize::try_from(index).ok().and_then(|i| set.get_mut(i));
            *inside.ok_or_else(|| {
                MeshError::new_err(format!(
                    "{name} has the index {index}, but the vertices are 0 to {}",
                    count.saturating_sub(1)
                ))
            })? = true;
        }
        return Ok(set);
    }
    let values = weights(name, value)?;
    if let Some(place) = values.iter().position(|value| value.is_nan()) {
        return Err(MeshError::new_err(format!(
            "{name}[{place}] is not a number"
        )));
    }
    Ok(values.iter().map(|&value| value >= 0.5).collect())
}

/// A list of indices, (N,).
pub fn indices(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<i64>> {
    // An empty list has no dtype that says integer.
    if value.len().is_ok_and(|length| length == 0) {
        return Ok(Vec::new());
    }
    flat(name, &numbers(name, value, INTEGERS, "int64")?)
}

fn flat<T: numpy::Element + Copy>(name: &str, array: &Bound<'_, PyAny>) -> PyResult<Vec<T>> {
    let array = array.cast::<PyArrayDyn<T>>()?;
    if array.ndim() != 1 {
        return Err(MeshError::new_err(format!(
            "{name} must be a list of numbers, not an array of shape {:?}",
            array.shape()
        )));
    }
    Ok(array.readonly().as_slice()?.to_vec())
}

/// (C, V) as a NumPy array (V, C).
pub fn per_vertex<'py>(py: Python<'py>, values: &Array2<f64>) -> Bound<'py, PyArray2<f64>> {
    values
        .t()
        .as_standard_layout()
        .into_owned()
        .into_pyarray(py)
}

/// `count` times (C, V) of the `shape` as one array (K, V, C), each taken when it is needed.
///
/// # Errors
/// [`Error::Memory`] if it does not fit, [`Error::Cancelled`].
pub fn stacked(
    count: usize,
    shape: (usize, usize),
    parts: impl Iterator<Item = Array2<f64>>,
    stage: Stage,
) -> spectral_tv::Result<Array3<f64>> {
    let (channels, vertices) = shape;
    let size = count.saturating_mul(vertices).saturating_mul(channels);
    let what = format!("an array of {count} states or bands of {vertices} vertices");
    let zeros = memory::zeros(size, &what, "take them in parts, fewer at a time")?;
    let mut stack = Array3::from_shape_vec((count, vertices, channels), zeros)
        .map_err(|error| Error::Memory(error.to_string()))?;
    for (mut place, part) in stack.outer_iter_mut().zip(parts) {
        stage.check()?;
        place.assign(&part.t());
    }
    Ok(stack)
}
