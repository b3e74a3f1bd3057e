//! Decompositions by every method, and what is made of them.

use arbitrary::{Arbitrary, Result, Unstructured};
use ndarray::Array2;
use spectral_tv::Named;
use spectral_tv::flow::{Scheme, Stepping};
use spectral_tv::mesh::TriangleMesh;
use spectral_tv::method::{
    AccuracyRequest, Base, Exaggeration, Flowing, Method, Metric, Settings, accuracy, caricature,
    decompose,
};
use spectral_tv::operators::positions;
use spectral_tv::solver::Solver;
use spectral_tv::spectral::even_edges;

use crate::number::{number, numbers, times, tolerance};
use crate::{assert_finite, largest, unless_refused};

/// Rounding of sums, relative to the largest summand.
const ROUNDING: f64 = 1e-12;

/// A decomposition, its bands and a filter of it.
#[derive(Debug, Arbitrary)]
pub struct Decompose {
    recipe: Recipe,
    #[arbitrary(with = numbers)]
    gains: Vec<f64>,
    #[arbitrary(with = numbers)]
    edges: Vec<f64>,
}

impl Decompose {
    pub fn run(&self, mesh: &TriangleMesh) {
        let settings = self.recipe.settings(mesh);
        let Some(split) = unless_refused(decompose(mesh, &settings)) else {
            return;
        };
        let components = split.component_times().len();
        assert_eq!(split.spectrum().len(), components);
        assert_finite("spectrum", split.spectrum());
        let residual = split.residual();
        assert_finite("residual", &residual);
        let mut largest_part = largest(&residual);
        let mut sum = residual;
        if components > 0 {
            let edges = even_edges(split.times(), components).expect("a band each");
            for band in split.bands(&edges).expect("even edges increase") {
                assert_finite("a band", &band);
                largest_part = largest_part.max(largest(&band));
                sum += &band;
            }
        }
        let shape = positions(mesh);
        let size = largest_part.max(largest(&shape)).max(base_size(&settings));
        let error = largest(&(&sum - &shape));
        assert!(error <= ROUNDING * size, "bands: {error:e} of {size:e}");
        let whole = split.filter(&vec![1.0; components]).expect("all pass");
        let error = largest(&(whole - shape));
        assert!(error <= ROUNDING * size, "all-pass: {error:e} of {size:e}");
        unless_refused(split.filter(&self.gains));
        if let Some(bands) = unless_refused(split.bands(&self.edges)) {
            bands.for_each(|band| assert_finite("a band", &band));
        }
    }
}

/// How large the coordinates of a given base are; what is measured from it is rounded likewise.
fn base_size(settings: &Settings) -> f64 {
    match &settings.base {
        Base::Shape(shape) => largest(shape),
        _ => 0.0,
    }
}

/// One filter for two shapes.
#[derive(Debug, Arbitrary)]
pub struct Caricature {
    recipe: Recipe,
    #[arbitrary(with = numbers)]
    filter: Vec<f64>,
}

impl Caricature {
    pub fn run(&self, mesh: &TriangleMesh) {
        let filter =
            |index: usize, default: f64| self.filter.get(index).map_or(default, |x| x.abs());
        let filter = Exaggeration {
            smooth: filter(0, 1e-4),
            from: filter(1, 2e-4),
            to: filter(2, 1e-3),
            gain: filter(3, 3.0),
            keep_limbs: filter(4, 0.0),
        };
        let settings = self.recipe.settings(mesh);
        let meshes = [mesh, mesh];
        let Some(shapes) = unless_refused(caricature(&meshes, &settings, &filter)) else {
            return;
        };
        let [first, second] = &shapes[..] else {
            panic!("two meshes gave {} shapes", shapes.len());
        };
        assert_eq!(first, second);
        if filter.gain < 1e50 {
            assert_finite("caricature", first);
        }
    }
}

/// Errors for some numbers of steps.
#[derive(Debug, Arbitrary)]
pub struct Accuracy {
    recipe: Recipe,
    #[arbitrary(with = few_steps)]
    steps: Vec<usize>,
    bands: u8,
    refinement: u8,
    #[arbitrary(with = scales)]
    scales: Option<(f64, f64)>,
}

impl Accuracy {
    pub fn run(&self, mesh: &TriangleMesh) {
        let request = AccuracyRequest {
            settings: self.recipe.settings(mesh),
            steps: self.steps.clone(),
            scales: self.scales,
            bands: usize::from(self.bands % 5),
            refinement: usize::from(self.refinement % 4),
            keep_limbs: f64::from(self.bands / 128),
        };
        let outcome = accuracy(mesh, &request);
        let Some(found) = unless_refused(outcome) else {
            return;
        };
        assert_eq!(found.edges.len(), request.bands + 1);
        for errors in [&found.ours, &found.paper] {
            assert_finite("errors of bands", &errors.bands);
            assert_finite("relative errors", &errors.relative);
        }
        assert_finite("all-pass errors", &found.ours.all_pass);
    }
}

fn few_steps(input: &mut Unstructured) -> Result<Vec<usize>> {
    let count = input.int_in_range(0..=2)?;
    (0..count).map(|_| input.int_in_range(1..=6)).collect()
}

fn scales(input: &mut Unstructured) -> Result<Option<(f64, f64)>> {
    match input.ratio(3, 4)? {
        true => Ok(None),
        false => Ok(Some((number(input)?, number(input)?))),
    }
}

/// Settings, but for a base, which has to have as many vertices as the mesh.
#[derive(Debug)]
pub struct Recipe {
    settings: Settings,
    base: Option<Vec<f64>>,
}

impl Recipe {
    /// Few plain steps of M2, fit for segments.
    pub fn of_segments() -> Self {
        Self {
            settings: Settings {
                steps: 4,
                ..Settings::m2()
            },
            base: None,
        }
    }

    /// The settings for `mesh`.
    pub fn settings(&self, mesh: &TriangleMesh) -> Settings {
        let mut settings = self.settings.clone();
        if let Some(moved) = &self.base {
            let mut shape: Array2<f64> = positions(mesh);
            for (value, shift) in shape.iter_mut().zip(moved.iter().cycle()) {
                *value += shift;
            }
            settings.base = Base::Shape(shape);
        }
        settings
    }
}

impl<'a> Arbitrary<'a> for Recipe {
    fn arbitrary(input: &mut Unstructured<'a>) -> Result<Self> {
        let method = *input.choose(&Method::NAMES)?;
        let mut settings = Settings::from(method.0);
        match settings.method {
            Method::ConformalLaplace => settings.p = input.int_in_range(0..=4)?,
            Method::DirectionalTv => {
                settings.metric = *input.choose(&[Metric::Surface, Metric::Base])?;
                settings.displacement = *input.choose(&[Flowing::Scalar, Flowing::Vector])?;
            }
            Method::LaplaceBeltrami => settings.eigenpairs = input.int_in_range(0..=40)?,
            _ => {}
        }
        let takes_base = settings.method.facts().takes_base;
        let mut base = None;
        match input.int_in_range(0..=7)? {
            4 if settings.method == Method::ShapeTv => {
                settings.total_variation.soft_edges = number(input)?;
            }
            5 if takes_base => settings.base = Base::Limbs,
            6 if takes_base => settings.base_time = Some(number(input)?),
            7 if takes_base => base = Some(numbers(input)?),
            _ => {}
        }
        if input.int_in_range(0..=3)? == 3 {
            settings.times = Some(times(input)?);
        }
        match input.int_in_range(0..=15)? {
            15 => settings.accuracy = Some(input.int_in_range(-1..=3)? as f64 / 4.0),
            fewer => settings.steps = 6 - fewer % 7,
        }
        settings.stepping = stepping(input)?;
        Ok(Self { settings, base })
    }
}

/// Any way to take steps.
pub fn stepping(input: &mut Unstructured) -> Result<Stepping> {
    Ok(Stepping {
        scheme: *input.choose(&[Scheme::Lagged, Scheme::Extrapolated, Scheme::Exact])?,
        tolerance: tolerance(input)?,
        solver: solver(input)?,
    })
}

/// Any solver.
pub fn solver(input: &mut Unstructured) -> Result<Solver> {
    Ok(*input.choose(&[
        Solver::Auto,
        Solver::Cholesky,
        Solver::Single,
        Solver::Multigrid,
    ])?)
}
