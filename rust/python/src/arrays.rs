//! NumPy arrays to the arrays of the mathematics and back.
//!
//! Python has a row per vertex, (V, C); the mathematics a row per channel, (C, V).

use ndarray::{Array2, Array3, ArrayView2};
use numpy::{
    Element, IntoPyArray, PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};
use spectral_tv::memory::{needs, vector, zeros};
use spectral_tv::monitor::Stage;

use crate::error::{Failure, MeshError};

/// Kinds of NumPy dtypes that hold numbers: signed, unsigned and floating.
const NUMBERS: &str = "iuf";
const INTEGERS: &str = "iu";
/// Truth values.
const TRUTH: &str = "b";
/// The same and truth values, which count as 0 and 1.
const WEIGHTS: &str = "iufb";

/// What a refusal of memory says of a copy.
const COPY: &str = "a copy of an array";
const LESS: &str = "take a smaller one";

/// Any array or what can be made one, of a dtype that is among the `kinds`; and its kind.
fn array<'py>(
    name: &str,
    value: &Bound<'py, PyAny>,
    kinds: &str,
) -> PyResult<(Bound<'py, PyAny>, String)> {
    refuse_masked(name, value)?;
    let refuse = |found: &str| {
        let wanted = if kinds == INTEGERS {
            "integers"
        } else {
            "numbers"
        };
        MeshError::new_err(format!("{name} must be an array of {wanted}, not {found}"))
    };
    let array = value
        .py()
        .import("numpy")?
        .call_method1("asarray", (value,))
        .map_err(|error| refuse(&format!("{}: {error}", of_type(value))))?;
    let found = array.getattr("dtype")?;
    let kind: String = found.getattr("kind")?.extract()?;
    if kinds.contains(&kind) {
        return Ok((array, kind));
    }
    // What NumPy can make nothing of is one object to it.
    let is_one_object = kind == "O" && array.getattr("ndim")?.extract::<usize>()? == 0;
    Err(match is_one_object && value.hasattr("toarray")? {
        true => refuse(&format!("{}; its toarray() would do", of_type(value))),
        false if is_one_object => refuse(&of_type(value)),
        false => refuse(&format!("of {found}")),
    })
}

fn of_type(value: &Bound<'_, PyAny>) -> String {
    let name = value.get_type().name();
    name.map_or("an object".into(), |name| format!("of the type {name}"))
}

/// Refuses arrays whose mask hides anything: NumPy would read what is under it.
fn refuse_masked(name: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
    let py = value.py();
    // Without it there are none.
    let modules = py.import("sys")?.getattr("modules")?;
    let Ok(masks) = modules.get_item("numpy.ma") else {
        return Ok(());
    };
    let class = masks.getattr("MaskedArray")?;
    let hidden = |value: &Bound<'_, PyAny>| -> PyResult<usize> {
        match value.is_instance(&class)? {
            true => masks.call_method1("count_masked", (value,))?.extract(),
            false => Ok(0),
        }
    };
    let is_list = value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>();
    let count = match is_list {
        true => value
            .try_iter()?
            .map(|row| hidden(&row?))
            .sum::<PyResult<usize>>()?,
        false => hidden(value)?,
    };
    match count {
        0 => Ok(()),
        1 => Err(masked(name, "1 value is masked")),
        count => Err(masked(name, &format!("{count} values are masked"))),
    }
}

fn masked(name: &str, found: &str) -> PyErr {
    MeshError::new_err(format!(
        "{name} must be an array of numbers, but {found}; {name}.filled(…) says what to take for them"
    ))
}

/// Reads an array of numbers of any shape, dtype and layout as `dtype`.
fn numbers<'py>(
    name: &str,
    value: &Bound<'py, PyAny>,
    kinds: &str,
    dtype: &str,
) -> PyResult<Bound<'py, PyAny>> {
    converted(&array(name, value, kinds)?.0, dtype)
}

/// An array of numbers as one of `dtype`, contiguous.
fn converted<'py>(array: &Bound<'py, PyAny>, dtype: &str) -> PyResult<Bound<'py, PyAny>> {
    let options = PyDict::new(array.py());
    options.set_item("dtype", dtype)?;
    options.set_item("order", "C")?;
    array.call_method("astype", (), Some(&options))
}

/// A copy of `values`; a `MemoryError` if there is no room for it.
pub fn copied<T: Copy>(values: &[T]) -> Result<Vec<T>, Failure> {
    let mut copy = vector(values.len(), COPY, LESS)?;
    copy.extend_from_slice(values);
    Ok(copy)
}

/// An array of shape (rows, 3) as rows.
fn triples<T: Element + Copy>(
    name: &str,
    array: &Bound<'_, PyAny>,
) -> Result<Vec<[T; 3]>, Failure> {
    with_triples(name, array, copied)
}

/// Does `work` on the rows of an array of shape (rows, 3).
fn with_triples<T: Element + Copy, U>(
    name: &str,
    array: &Bound<'_, PyAny>,
    work: impl FnOnce(&[[T; 3]]) -> Result<U, Failure>,
) -> Result<U, Failure> {
    let array = array.cast::<PyArrayDyn<T>>().map_err(PyErr::from)?;
    let shape = array.shape();
    if shape.len() != 2 || shape[1] != 3 {
        return Err(MeshError::new_err(format!(
            "{name} must have the shape (rows, 3), not {shape:?}"
        ))
        .into());
    }
    let read = array.readonly();
    work(read.as_slice().map_err(PyErr::from)?.as_chunks::<3>().0)
}

/// Positions, (V, 3) numbers.
pub fn positions(name: &str, value: &Bound<'_, PyAny>) -> Result<Vec<[f64; 3]>, Failure> {
    triples(name, &numbers(name, value, NUMBERS, "float64")?)
}

/// Positions for each of a sequence, (V, 3) numbers each.
pub fn several_positions(
    name: &str,
    values: &[Bound<'_, PyAny>],
) -> Result<Vec<Vec<[f64; 3]>>, Failure> {
    values.iter().map(|value| positions(name, value)).collect()
}

/// Does short `work` on positions, which are read but once.
pub fn with_positions<T>(
    name: &str,
    value: &Bound<'_, PyAny>,
    work: impl FnOnce(&[[f64; 3]]) -> Result<T, Failure>,
) -> Result<T, Failure> {
    // A copy of the value that nobody else has.
    with_triples(name, &numbers(name, value, NUMBERS, "float64")?, work)
}

/// A shape, (V, 3) numbers, as (3, V).
pub fn shape(name: &str, value: &Bound<'_, PyAny>) -> Result<Array2<f64>, Failure> {
    let rows = positions(name, value)?;
    by_channel(rows.as_flattened(), rows.len(), 3)
}

/// Index triples, (F, 3) integers.
pub fn index_triples(name: &str, value: &Bound<'_, PyAny>) -> Result<Vec<[i64; 3]>, Failure> {
    triples(name, &numbers(name, value, INTEGERS, "int64")?)
}

/// Values row by row, (rows, C), as (C, rows).
fn by_channel(flat: &[f64], rows: usize, channels: usize) -> Result<Array2<f64>, Failure> {
    let mut values = vector(flat.len(), COPY, LESS)?;
    for channel in 0..channels {
        values.extend((0..rows).map(|row| flat[row * channels + channel]));
    }
    shaped(values, (channels, rows))
}

fn shaped<T>(values: Vec<T>, shape: (usize, usize)) -> Result<Array2<T>, Failure> {
    let shaped = Array2::from_shape_vec(shape, values);
    Ok(shaped.map_err(|error| MeshError::new_err(error.to_string()))?)
}

/// Values of shape (V,) or (V, C) as (C, V), and whether they had the first shape.
pub fn channels(name: &str, value: &Bound<'_, PyAny>) -> Result<(Array2<f64>, bool), Failure> {
    let array = numbers(name, value, NUMBERS, "float64")?;
    let array = array.cast::<PyArrayDyn<f64>>().map_err(PyErr::from)?;
    let shape = array.shape().to_vec();
    let (rows, count) = match shape[..] {
        [rows] => (rows, 1),
        [rows, count] => (rows, count),
        _ => {
            return Err(MeshError::new_err(format!(
                "{name} must have the shape (V,) or (V, C), not {shape:?}"
            ))
            .into());
        }
    };
    let read = array.readonly();
    let values = by_channel(read.as_slice().map_err(PyErr::from)?, rows, count)?;
    Ok((values, shape.len() == 1))
}

/// Pixels of shape (H, W) or (H, W, C) as (C, H × W), with H and W, and whether there were channels.
pub fn pixels(
    name: &str,
    value: &Bound<'_, PyAny>,
) -> Result<(Array2<f64>, [usize; 2], bool), Failure> {
    let array = numbers(name, value, NUMBERS, "float64")?;
    let array = array.cast::<PyArrayDyn<f64>>().map_err(PyErr::from)?;
    let shape = array.shape().to_vec();
    let (rows, columns, count) = match shape[..] {
        [rows, columns] => (rows, columns, 1),
        [rows, columns, count] if count > 0 => (rows, columns, count),
        _ => {
            return Err(MeshError::new_err(format!(
                "{name} must have the shape (H, W) or (H, W, C), not {shape:?}"
            ))
            .into());
        }
    };
    let read = array.readonly();
    let values = by_channel(read.as_slice().map_err(PyErr::from)?, rows * columns, count)?;
    Ok((values, [rows, columns], shape.len() == 3))
}

/// Rows of numbers as they are, (rows, columns).
pub fn matrix<T: Element + Copy>(
    name: &str,
    value: &Bound<'_, PyAny>,
    dtype: &str,
) -> Result<Array2<T>, Failure> {
    let array = numbers(name, value, NUMBERS, dtype)?;
    let array = array.cast::<PyArrayDyn<T>>().map_err(PyErr::from)?;
    let [rows, columns] = array.shape() else {
        let message = format!("{name} must have two axes, not {}", array.ndim());
        return Err(MeshError::new_err(message).into());
    };
    let read = array.readonly();
    shaped(
        copied(read.as_slice().map_err(PyErr::from)?)?,
        (*rows, *columns),
    )
}

/// A list of numbers, (N,).
pub fn list(name: &str, value: &Bound<'_, PyAny>) -> Result<Vec<f64>, Failure> {
    flat(name, &numbers(name, value, NUMBERS, "float64")?)
}

/// A list of numbers or truth values, (N,).
pub fn weights(name: &str, value: &Bound<'_, PyAny>) -> Result<Vec<f64>, Failure> {
    flat(name, &numbers(name, value, WEIGHTS, "float64")?)
}

/// A list of truth values, (N,).
pub fn truth(name: &str, value: &Bound<'_, PyAny>) -> Result<Vec<bool>, Failure> {
    flat(name, &numbers(name, value, TRUTH, "bool")?)
}

/// A list of indices, (N,).
pub fn indices(name: &str, value: &Bound<'_, PyAny>) -> Result<Vec<i64>, Failure> {
    // An empty list has no dtype that says integer.
    if value.len().is_ok_and(|length| length == 0) {
        return Ok(Vec::new());
    }
    flat(name, &numbers(name, value, INTEGERS, "int64")?)
}

fn flat<T: Element + Copy>(name: &str, array: &Bound<'_, PyAny>) -> Result<Vec<T>, Failure> {
    let array = array.cast::<PyArrayDyn<T>>().map_err(PyErr::from)?;
    if array.ndim() != 1 {
        return Err(MeshError::new_err(format!(
            "{name} must be a list of numbers, not an array of shape {:?}",
            array.shape()
        ))
        .into());
    }
    copied(array.readonly().as_slice().map_err(PyErr::from)?)
}

/// A set of `count` vertices: a truth value for each, or a number, which is in it from 0.5 on; or
/// integers, the vertices' indices. Integers that are 0 or 1 for every vertex are truth values, too.
pub fn set(name: &str, value: &Bound<'_, PyAny>, count: usize) -> Result<Vec<bool>, Failure> {
    let (array, kind) = array(name, value, WEIGHTS)?;
    if kind == "f" && array.getattr("size")?.extract::<usize>()? > 0 {
        let values: Vec<f64> = flat(name, &converted(&array, "float64")?)?;
        return match values.iter().position(|value| value.is_nan()) {
            Some(place) => {
                Err(MeshError::new_err(format!("{name}[{place}] is not a number")).into())
            }
            None => Ok(values.iter().map(|&value| value >= 0.5).collect()),
        };
    }
    let indices = match vertices(name, value, count)? {
        Vertices::Mask(mask) => return Ok(mask),
        Vertices::Indices(indices) => indices,
    };
    let mut places = vec![None; count];
    for (place, &index) in indices.iter().enumerate() {
        let inside = usize::try_from(index).ok().and_then(|i| places.get_mut(i));
        let known = inside.ok_or_else(|| {
            MeshError::new_err(format!(
                "{name} has the index {index}, but the vertices are 0 to {}",
                count.saturating_sub(1)
            ))
        })?;
        if let Some(first) = known.replace(place) {
            return Err(MeshError::new_err(format!(
                "{name} has the index {index} twice, in places {first} and {place}; if these are \
                 values at the vertices, there must be one, 0 or 1, for each of the {count}, or \
                 truth values, as of {name} == 1"
            ))
            .into());
        }
    }
    Ok(places.iter().map(Option::is_some).collect())
}

/// Which vertices are meant: some by their indices, or all by a truth value each.
pub enum Vertices {
    Mask(Vec<bool>),
    Indices(Vec<i64>),
}

/// Vertices of a mesh of `count` by their indices, or by a mask: truth values, or integers that are
/// 0 or 1 for each of them. As indices these would name two vertices again and again.
pub fn vertices(name: &str, value: &Bound<'_, PyAny>, count: usize) -> Result<Vertices, Failure> {
    let is_empty = value.len().is_ok_and(|length| length == 0);
    if !is_empty && array(name, value, WEIGHTS)?.1 == TRUTH {
        let mask = truth(name, value)?;
        return match mask.len() == count {
            true => Ok(Vertices::Mask(mask)),
            false => Err(MeshError::new_err(format!(
                "{name} has {} truth values, but there are {count} vertices",
                mask.len()
            ))
            .into()),
        };
    }
    let indices = indices(name, value)?;
    let is_mask = indices.len() == count && count > 2 && indices.iter().all(|i| [0, 1].contains(i));
    Ok(match is_mask {
        true => Vertices::Mask(indices.iter().map(|&index| index == 1).collect()),
        false => Vertices::Indices(indices),
    })
}

/// (N,) as a NumPy array.
pub fn array_of<'py, T: Element + Copy>(
    py: Python<'py>,
    values: &[T],
) -> Result<Bound<'py, PyArray1<T>>, Failure> {
    Ok(copied(values)?.into_pyarray(py))
}

/// So many numbers as a NumPy array.
pub fn collected<T: Element>(
    py: Python<'_>,
    values: impl ExactSizeIterator<Item = T>,
) -> Result<Bound<'_, PyArray1<T>>, Failure> {
    let mut array = vector(values.len(), COPY, LESS)?;
    array.extend(values);
    Ok(array.into_pyarray(py))
}

/// (rows, columns) as a NumPy array of the same shape.
pub fn table_of<'py, T: Element + Copy>(
    py: Python<'py>,
    values: ArrayView2<T>,
) -> Result<Bound<'py, PyArray2<T>>, Failure> {
    let mut copy = vector(values.len(), COPY, LESS)?;
    copy.extend(values.iter().copied());
    Ok(shaped(copy, values.dim())?.into_pyarray(py))
}

/// Triples as a NumPy array, (rows, 3).
pub fn rows<'py, T: Element>(
    py: Python<'py>,
    triples: impl ExactSizeIterator<Item = [T; 3]>,
) -> Result<Bound<'py, PyArray2<T>>, Failure> {
    let count = triples.len();
    let mut flat = vector(3 * count, COPY, LESS)?;
    for triple in triples {
        flat.extend(triple);
    }
    Ok(shaped(flat, (count, 3))?.into_pyarray(py))
}

/// (C, V) as a NumPy array (V, C).
pub fn per_vertex<'py>(
    py: Python<'py>,
    values: ArrayView2<f64>,
) -> Result<Bound<'py, PyArray2<f64>>, Failure> {
    let zeros = zeros(values.len(), COPY, LESS)?;
    let mut rows = shaped(zeros, (values.ncols(), values.nrows()))?;
    rows.assign(&values.t());
    Ok(rows.into_pyarray(py))
}

/// `count` times (C, V) of the `shape` as one array (K, V, C), each taken when it is needed.
///
/// # Errors
/// [`spectral_tv::Error::Memory`] if it does not fit, [`spectral_tv::Error::Cancelled`].
pub fn stacked(
    count: usize,
    shape: (usize, usize),
    parts: impl Iterator<Item = Array2<f64>>,
    stage: Stage,
) -> spectral_tv::Result<Array3<f64>> {
    let (channels, vertices) = shape;
    let what = format!("an array of {count} states or bands of {vertices} vertices");
    let advice = "take them in parts, fewer at a time";
    // Each is there by itself as well, and what it is summed up in.
    let functions = count.saturating_add(3).saturating_mul(channels);
    stage.require(needs::functions(functions, vertices as u64), &what, advice)?;
    let size = count.saturating_mul(vertices).saturating_mul(channels);
    let zeros = zeros(size, &what, advice)?;
    let mut stack = Array3::from_shape_vec((count, vertices, channels), zeros)
        .map_err(|error| spectral_tv::Error::Memory(error.to_string()))?;
    for (mut place, part) in stack.outer_iter_mut().zip(parts) {
        stage.check()?;
        place.assign(&part.t());
    }
    Ok(stack)
}
