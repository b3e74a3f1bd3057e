//! Python's keywords to the settings of the library, and what is known of each option and method.

use numpy::{IntoPyArray, PyArray1};
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use spectral_tv::Named;
use spectral_tv::flow::Stepping;
use spectral_tv::method::{self, Choice, Kind, Method, OPTIONS, Settings, Value};

use crate::arrays;
use crate::error::Failure;
use crate::job::guarded;
use crate::parameters::{self, Number};

/// The settings of a decomposition by the keywords of their options, and "method".
pub fn settings(options: &Bound<'_, PyDict>) -> Result<Settings, Failure> {
    let mut settings = Settings::default();
    for (name, value) in options {
        let name: String = name.extract()?;
        if name == Method::ARGUMENT {
            settings.method = Method::named(&text(&name, &value)?)?;
            continue;
        }
        let option = Choice::named(&name).ok_or_else(|| {
            PyTypeError::new_err(format!("got an unexpected keyword argument '{name}'"))
        })?;
        option.set(&mut settings, read(option, &value)?)?;
    }
    settings.check()?;
    Ok(settings)
}

/// How the steps of a flow are taken, by the same keywords.
pub fn stepping(options: &Bound<'_, PyDict>) -> Result<Stepping, Failure> {
    Ok(settings(options)?.stepping)
}

fn read(option: &Choice, value: &Bound<'_, PyAny>) -> Result<Value, Failure> {
    let name = option.name;
    if option.is_optional && value.is_none() {
        return Ok(Value::None);
    }
    Ok(match option.kind {
        Kind::Count => Value::Count(usize::read(name, value)?),
        Kind::Number => Value::Number(f64::read(name, value)?),
        Kind::Name => Value::Name(text(name, value)?),
        Kind::List => Value::List(arrays::list(name, value)?),
        Kind::NameOrShape => match value.extract() {
            Ok(name) => Value::Name(name),
            Err(_) => Value::Shape(arrays::shape(name, value)?),
        },
    })
}

/// The name of a choice.
fn text(name: &str, value: &Bound<'_, PyAny>) -> PyResult<String> {
    let refuse = |_| PyTypeError::new_err(format!("{name} must be a str, not {value}"));
    value.extract().map_err(refuse)
}

/// One of the variants that an argument names.
pub fn named<T: Named>(name: &Bound<'_, PyAny>) -> PyResult<T> {
    let name = text(T::ARGUMENT, name)?;
    T::named(&name).map_err(|error| Failure::from(error).into())
}

/// The same, or none.
pub fn named_or_none<T: Named>(name: &Bound<'_, PyAny>) -> PyResult<Option<T>> {
    match name.is_none() {
        true => Ok(None),
        false => named(name).map(Some),
    }
}

/// What is known of options and methods: the defaults by the names of the options, and the facts of
/// each method by its name.
#[pyfunction]
pub fn _facts(py: Python<'_>) -> PyResult<(Bound<'_, PyDict>, Bound<'_, PyDict>)> {
    let (defaults, methods) = (PyDict::new(py), PyDict::new(py));
    let default = Settings::default();
    defaults.set_item(Method::ARGUMENT, default.method.name())?;
    for option in OPTIONS {
        defaults.set_item(option.name, written(py, (option.get)(&default))?)?;
    }
    for &(method, name) in Method::NAMES {
        let (facts, known) = (method.facts(), PyDict::new(py));
        known.set_item("takes_steps", facts.takes_steps())?;
        known.set_item("takes_base", facts.takes_base)?;
        known.set_item("has_exact_steps", facts.has_exact_steps())?;
        let options = OPTIONS.iter().filter(|option| (option.applies)(method));
        known.set_item(
            "options",
            options.map(|option| option.name).collect::<Vec<_>>(),
        )?;
        methods.set_item(name, known)?;
    }
    Ok((defaults, methods))
}

fn written(py: Python<'_>, value: Value) -> PyResult<Bound<'_, PyAny>> {
    match value {
        Value::None => Ok(py.None().into_bound(py)),
        Value::Count(count) => count.into_bound_py_any(py),
        Value::Number(number) => number.into_bound_py_any(py),
        Value::Name(name) => name.into_bound_py_any(py),
        Value::List(numbers) => numbers.into_bound_py_any(py),
        Value::Shape(shape) => Ok(arrays::per_vertex(py, shape.view())?.into_any()),
    }
}

/// The finest and the largest scale of a method by default, t/area.
#[pyfunction]
pub fn default_scales(options: &Bound<'_, PyDict>) -> Result<(f64, f64), Failure> {
    Ok(settings(options)?.relative_scales())
}

/// How far the flow to a base goes by default, t/area.
#[pyfunction]
pub fn default_base_time(options: &Bound<'_, PyDict>) -> Result<f64, Failure> {
    Ok(settings(options)?.base_duration(1.0))
}

/// Times from 0, evenly spaced at first and from about `finest` on in log t.
#[pyfunction]
pub fn graded_times(
    py: Python<'_>,
    #[pyo3(from_py_with = parameters::finest)] finest: f64,
    #[pyo3(from_py_with = parameters::largest)] largest: f64,
    #[pyo3(from_py_with = parameters::steps)] steps: usize,
) -> Result<Bound<'_, PyArray1<f64>>, Failure> {
    let times = guarded(py, |_| method::graded_times(finest, largest, steps))?;
    Ok(times.into_pyarray(py))
}

/// A filter at the times of the components: its values there, or a function of a time.
pub fn gains(gains: &Bound<'_, PyAny>, times: &[f64]) -> Result<Vec<f64>, Failure> {
    match gains.is_callable() {
        true => {
            let gain = |time: &f64| f64::read("gains", &gains.call1((*time,))?);
            Ok(times.iter().map(gain).collect::<PyResult<_>>()?)
        }
        false => arrays::list("gains", gains),
    }
}
