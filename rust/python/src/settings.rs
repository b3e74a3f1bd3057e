//! Strings and keywords of the Python interface to settings of the mathematics.

use ndarray::Array2;
use pyo3::prelude::*;
use spectral_tv::Error;
use spectral_tv::flow::Weights;
use spectral_tv::method::{Base, Method, Scheme, Settings};

use crate::arrays;
use crate::error::Failure;

/// The keyword arguments of `decompose` and `start_decompose`.
pub struct Request<'a, 'py> {
    pub method: &'a str,
    pub times: Option<Bound<'py, PyAny>>,
    pub steps: usize,
    pub scheme: &'a str,
    pub tolerance: f64,
    pub p: u32,
    pub base: Option<Bound<'py, PyAny>>,
}

impl Request<'_, '_> {
    /// What the mathematics makes of it.
    pub fn settings(&self) -> Result<Settings, Failure> {
        Ok(Settings {
            method: self.method()?,
            times: match &self.times {
                Some(times) => Some(arrays::list("times", times)?),
                None => None,
            },
            steps: self.steps,
            scheme: scheme(self.scheme, self.tolerance)?,
        })
    }

    fn method(&self) -> Result<Method, Failure> {
        if self.base.is_some() && self.method != "m3" {
            return Err(Error::Argument("base is for the method \"m3\" only".into()).into());
        }
        match self.method {
            "heat" => Ok(Method::Heat),
            "naive" => Ok(Method::Naive),
            "m1" => Ok(Method::ShapeTv),
            "m2" => Ok(Method::ConformalLaplace { p: self.p }),
            "m3" => Ok(Method::DirectionalTv {
                base: match &self.base {
                    Some(base) => Base::Shape(shape(base)?),
                    None => Base::default(),
                },
            }),
            other => Err(Error::Argument(format!(
                "method must be \"naive\", \"m1\", \"m2\", \"m3\" or \"heat\", not {other:?}"
            ))
            .into()),
        }
    }
}

/// The way steps are taken.
pub fn scheme(name: &str, tolerance: f64) -> Result<Scheme, Failure> {
    match name {
        "lagged" => Ok(Scheme::SemiImplicit(Weights::Lagged)),
        "extrapolated" => Ok(Scheme::SemiImplicit(Weights::Extrapolated)),
        "exact" => Ok(Scheme::Exact { tolerance }),
        other => Err(Error::Argument(format!(
            "scheme must be \"lagged\", \"extrapolated\" or \"exact\", not {other:?}"
        ))
        .into()),
    }
}

fn shape(value: &Bound<'_, PyAny>) -> PyResult<Array2<f64>> {
    let rows = arrays::positions("base", value)?;
    Ok(Array2::from_shape_fn((3, rows.len()), |(axis, vertex)| {
        rows[vertex][axis]
    }))
}
