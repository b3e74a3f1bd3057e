//! Strings and keywords of the Python interface to settings of the mathematics.

use ndarray::Array2;
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use spectral_tv::flow::Weights;
use spectral_tv::method::{self, Base, Method, Metric, Scheme, Settings, Steps, relative_scales};
use spectral_tv::minimization::check_tolerance;
use spectral_tv::solver::Solver;

use crate::arrays;
use crate::error::{Failure, refused};
use crate::job::guarded;
use crate::parameters::{self, Number};

/// The keyword arguments of `decompose` and `start_decompose`.
pub struct Request<'a, 'py> {
    pub method: &'a str,
    pub times: Option<Bound<'py, PyAny>>,
    pub steps: usize,
    pub accuracy: Option<f64>,
    pub scheme: &'a str,
    pub tolerance: f64,
    pub solver: &'a str,
    pub p: u32,
    pub base: Option<Bound<'py, PyAny>>,
    pub base_time: Option<f64>,
    pub eigenpairs: usize,
    pub metric: &'a str,
}

impl<'a> Request<'a, '_> {
    /// A method with all else by default.
    pub fn plain(method: &'a str, steps: usize) -> Self {
        Self {
            method,
            times: None,
            steps,
            accuracy: None,
            scheme: "extrapolated",
            tolerance: 1e-3,
            solver: "auto",
            p: 3,
            base: None,
            base_time: None,
            eigenpairs: 300,
            metric: "surface",
        }
    }

    /// What the mathematics makes of it.
    pub fn settings(&self) -> Result<Settings, Failure> {
        Ok(Settings {
            method: self.method()?,
            times: match &self.times {
                Some(times) => Some(arrays::list("times", times)?),
                None => None,
            },
            steps: match self.accuracy {
                Some(accuracy) => {
                    method::check_accuracy(accuracy)?;
                    Steps::Accuracy(accuracy)
                }
                None => Steps::Count(self.steps),
            },
            scheme: scheme(self.scheme, self.tolerance)?,
            solver: solver(self.solver)?,
        })
    }

    fn method(&self) -> Result<Method, Failure> {
        if !(1..=3).contains(&self.p) {
            let message = format!("p must be 1, 2 or 3, not {}", self.p);
            return Err(refused(message));
        }
        if self.eigenpairs == 0 {
            return Err(refused("eigenpairs must be at least 1"));
        }
        let has_base = matches!(self.method, "m3" | "displacement");
        if (self.base.is_some() || self.base_time.is_some()) && !has_base {
            let message = "base and base_time are for the methods \"m3\" and \"displacement\" only";
            return Err(refused(message));
        }
        if self.base.is_some() && self.base_time.is_some() {
            let message = "base_time smooths the mesh itself, so it does not go with base";
            return Err(refused(message));
        }
        let metric = match self.metric {
            "surface" => Metric::Surface,
            "base" if self.method == "m3" => Metric::Base,
            "base" => {
                let message = "the metric \"base\" is for the method \"m3\" only";
                return Err(refused(message));
            }
            other => {
                let message = format!("metric must be \"surface\" or \"base\", not {other:?}");
                return Err(refused(message));
            }
        };
        match self.method {
            "heat" => Ok(Method::Heat),
            "naive" => Ok(Method::Naive),
            "m1" => Ok(Method::ShapeTv),
            "m2" => Ok(Method::ConformalLaplace { p: self.p }),
            "m3" => Ok(Method::DirectionalTv {
                base: self.base()?,
                metric,
            }),
            "lb" => Ok(Method::LaplaceBeltrami {
                eigenpairs: self.eigenpairs,
            }),
            "displacement" => Ok(Method::Displacement { base: self.base()? }),
            other => Err(refused(format!(
                "method must be \"m1\", \"m2\", \"m3\", \"naive\", \"heat\", \"lb\" or \
                 \"displacement\", not {other:?}"
            ))),
        }
    }

    fn base(&self) -> Result<Base, Failure> {
        Ok(match &self.base {
            Some(base) => Base::Shape(shape(base)?),
            None => Base::ConformalFlow {
                time: self.base_time,
                steps: None,
            },
        })
    }
}

/// The default scales of a method relative to the area: the time from which steps are spaced
/// in log t, and the last time.
///
/// Parameters
/// ----------
/// method : {"m1", "m2", "m3", "naive", "heat", "lb", "displacement"}
/// eigenpairs : int
///     Of "lb", whose finest scale is that of the last.
///
/// Returns
/// -------
/// (float, float)
///     t/area of the finest and the largest scale; see `graded_times`.
///
/// Raises
/// ------
/// MeshError
///     If there is no such method.
#[pyfunction]
#[pyo3(signature = (method, eigenpairs = 300))]
pub fn default_scales(
    method: &str,
    #[pyo3(from_py_with = parameters::eigenpairs)] eigenpairs: usize,
) -> Result<(f64, f64), Failure> {
    let request = Request {
        eigenpairs,
        ..Request::plain(method, 1)
    };
    Ok(relative_scales(&request.method()?))
}

/// How far "m3" and "displacement" smooth their base where neither `base` nor `base_time` is given.
///
/// Returns
/// -------
/// float
///     t/area: features of the size ℓ vanish from the base at a time of the order of ℓ².
#[pyfunction]
pub fn default_base_time() -> f64 {
    Base::default().duration(1.0)
}

/// Times for `decompose`: from 0, evenly spaced at first and from about `finest` on in log t.
///
/// Parameters
/// ----------
/// finest, largest : float
///     Times, length². Features of the size ℓ vanish at a time of the order of ℓ².
/// steps : int
///     Number of steps N.
///
/// Returns
/// -------
/// (N+1,) array
///
/// Raises
/// ------
/// MeshError
///     If steps is 0 or 0 < finest < largest does not hold.
#[pyfunction]
#[pyo3(signature = (finest, largest, steps = 32))]
pub fn graded_times(
    py: Python<'_>,
    #[pyo3(from_py_with = parameters::finest)] finest: f64,
    #[pyo3(from_py_with = parameters::largest)] largest: f64,
    #[pyo3(from_py_with = parameters::steps)] steps: usize,
) -> Result<Bound<'_, PyArray1<f64>>, Failure> {
    let times = guarded(py, |_| method::graded_times(finest, largest, steps))?;
    Ok(times.into_pyarray(py))
}

/// The way steps are taken.
pub fn scheme(name: &str, tolerance: f64) -> Result<Scheme, Failure> {
    // Refused even where it is of no account: it is a mistake in any case.
    check_tolerance(tolerance)?;
    match name {
        "lagged" => Ok(Scheme::SemiImplicit(Weights::Lagged)),
        "extrapolated" => Ok(Scheme::SemiImplicit(Weights::Extrapolated)),
        "exact" => Ok(Scheme::Exact { tolerance }),
        other => Err(refused(format!(
            "scheme must be \"lagged\", \"extrapolated\" or \"exact\", not {other:?}"
        ))),
    }
}

/// The way linear systems are solved.
pub fn solver(name: &str) -> Result<Solver, Failure> {
    match name {
        "auto" => Ok(Solver::Auto),
        "cholesky" => Ok(Solver::Cholesky),
        "multigrid" => Ok(Solver::Multigrid),
        other => Err(refused(format!(
            "solver must be \"auto\", \"cholesky\" or \"multigrid\", not {other:?}"
        ))),
    }
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

fn shape(value: &Bound<'_, PyAny>) -> Result<Array2<f64>, Failure> {
    let rows = arrays::positions("base", value)?;
    Ok(Array2::from_shape_fn((3, rows.len()), |(axis, vertex)| {
        rows[vertex][axis]
    }))
}
