//! How accurate a decomposition is for its number of steps.
//!
//! A filter that passes everything has to give the shape back. The paper measures accuracy by what
//! that filter leaves out (Brokman et al. 2024, Sec. 9.2). With the transform of
//! [`crate::spectral`] it leaves out nothing, however long the steps are. So here the measure is
//! the difference of the bands from those of a refined flow. Both are measured, for the steps asked
//! for and for the paper's.

use ndarray::{Array2, Axis};

use crate::discretization::Discretization;
use crate::error::{ArgumentError, Error, Result};
use crate::flow::{Scheme, Trajectory, check_steps, velocity};
use crate::memory::needs;
use crate::mesh::TriangleMesh;
use crate::method::band_errors::{band_errors, lengths};
use crate::method::decompose::run_flows;
use crate::method::representation::{Flowed, Representation, no_time_steps};
use crate::method::requirements::decomposition_memory_of;
use crate::method::{Settings, graded_times};
use crate::monitor::{Monitor, Stage};
use crate::spectral::{SpectralTransform, ThicknessCut, band_between, even_edges};

/// Share of the progress that is given to the representation.
const REPRESENTATION_SHARE: f64 = 0.1;

/// What is measured.
#[derive(Debug, Clone)]
pub struct AccuracyRequest {
    /// How the shape is decomposed; its `times` and `steps` are not used.
    pub settings: Settings,
    /// The numbers of steps, n.
    pub steps: Vec<usize>,
    /// The finest and the largest scale, length², as [`graded_times`] takes them; `None`: those
    /// of the method.
    pub scales: Option<(f64, f64)>,
    /// Number of bands K.
    pub bands: usize,
    /// The refined flow has so many times the most steps.
    pub refinement: usize,
    /// How much of limbs the bands leave, see [`crate::method::Decomposition::bands_keeping_limbs`].
    pub keep_limbs: f64,
}

/// The errors of one way of stepping.
#[derive(Debug, Clone)]
pub struct Errors {
    /// |f^1 − f| for the filter H = 1, for every number of steps and vertex, (n, V), length.
    pub all_pass: Array2<f64>,
    /// The root of the sum over bands of |band − refined band|², (n, V), length.
    pub bands: Array2<f64>,
    /// ‖band − refined band‖ / ‖refined band‖ over the surface, (n, K).
    pub relative: Array2<f64>,
}

/// What was measured.
#[derive(Debug, Clone)]
pub struct Accuracy {
    /// The numbers of steps, n.
    pub steps: Vec<usize>,
    /// Where the K bands begin and end, K + 1, length².
    pub edges: Vec<f64>,
    /// Of the settings' steps and the exact transform.
    pub ours: Errors,
    /// Of the paper's: weights lagged by a step, and R = T p(u(T)) + u(T) with p taken at u(T).
    pub paper: Errors,
}

/// Measures how the errors of a decomposition of `mesh` fall with the number of steps.
///
/// ```
/// use spectral_tv::method::{AccuracyRequest, Settings, accuracy};
///
/// # use spectral_tv::mesh::TriangleMesh;
/// # let vertices = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0.3, 0.3, 1.]];
/// # let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// # let mesh = TriangleMesh::new(vertices, &triangles)?;
/// let request = AccuracyRequest {
///     settings: Settings::m1(),
///     steps: vec![4, 8],
///     scales: None,
///     bands: 3,
///     refinement: 4,
///     keep_limbs: 0.0,
/// };
/// let found = accuracy(&mesh, &request)?;
/// assert_eq!(found.ours.relative.dim(), (2, 3));
/// // The exact transform gives the shape back; the paper's does not.
/// assert!(found.ours.all_pass[[0, 3]] < 1e-9);
/// assert!(found.paper.all_pass[[0, 3]] > 1e-9);
/// # Ok::<(), spectral_tv::Error>(())
/// ```
///
/// # Errors
/// If there are no steps, no bands or no refinement, the method takes no steps, or as
/// [`crate::method::decompose`].
pub fn accuracy(mesh: &TriangleMesh, request: &AccuracyRequest) -> Result<Accuracy> {
    accuracy_with(mesh, request, Monitor::new().whole())
}

/// [`accuracy`], watched: `stage` tells how far it is, and cancels it.
///
/// # Errors
/// As [`accuracy`], or [`crate::Error::Cancelled`].
pub fn accuracy_with(
    mesh: &TriangleMesh,
    request: &AccuracyRequest,
    stage: Stage,
) -> Result<Accuracy> {
    let AccuracyRequest {
        settings, steps, ..
    } = request;
    let Some(&most) = steps.iter().max() else {
        return Err(ArgumentError::empty("steps", "steps must have at least one value").into());
    };
    if request.refinement < 2 {
        let found = request.refinement;
        return Err(ArgumentError::value("refinement", "must be at least 2", found).into());
    }
    let times = |steps: usize| match request.scales {
        Some((finest, largest)) => graded_times(finest, largest, steps),
        None => settings.default_times(mesh.area(), steps),
    };
    settings.check()?;
    if !settings.method.facts().takes_steps() {
        return Err(no_time_steps());
    }
    for &count in steps {
        if count < 2 {
            return Err(ArgumentError::value("steps", "must be at least 2", count).into());
        }
        check_steps(count)?;
    }
    let refined = request.refinement.saturating_mul(most);
    check_steps(refined)?;
    let edges = even_edges(&times(most)?, request.bands)?;
    stage.require(
        memory(mesh, request, refined),
        &format!(
            "a flow of {refined} steps on {} vertices, to measure by,",
            mesh.vertex_count()
        ),
        "take fewer steps or bands, less refinement, or a mesh of fewer vertices",
    )?;
    let operators = Discretization::for_flows(mesh, stage)?;
    let share = stage.stage(0.0, REPRESENTATION_SHARE);
    let Representation { flows, along, .. } =
        Representation::new(mesh, &operators, settings, share)?;
    let operators = along.map_or(operators, |(_, operators)| operators);
    let masses = operators.vertex_masses();

    let work = (refined + 2 * steps.iter().sum::<usize>()) as f64;
    let mut done = 0;
    let mut run = |scheme: Scheme, count: usize| {
        let share =
            |done: usize| REPRESENTATION_SHARE + (1.0 - REPRESENTATION_SHARE) * done as f64 / work;
        let stage = stage.stage(share(done), share(done + count));
        done += count;
        let mut settings = settings.clone();
        settings.stepping.scheme = scheme;
        let again = flows
            .iter()
            .map(|Flowed { law, values }| (&**law, values.clone()));
        run_flows(&operators, again, &settings, &times(count)?, stage)
    };
    let cut = ThicknessCut::new(mesh, request.keep_limbs, share)?;
    let bands = |trajectory: &Trajectory| -> Vec<_> {
        let whole = |edge: &[f64]| band_between(trajectory, [edge[0], edge[1]]);
        match &cut {
            None => edges.windows(2).map(whole).collect(),
            Some(cut) => cut.clone().bands(trajectory, &edges).collect(),
        }
    };
    let refined = bands(&run(settings.stepping.scheme, refined)?);
    let mut measure = |scheme: Scheme, is_paper: bool| {
        let mut errors = Errors {
            all_pass: Array2::zeros((0, mesh.vertex_count())),
            bands: Array2::zeros((0, mesh.vertex_count())),
            relative: Array2::zeros((0, request.bands)),
        };
        for &count in steps {
            let trajectory = run(scheme, count)?;
            let (distance, relative) = band_errors(&bands(&trajectory), &refined, &masses);
            let transform = SpectralTransform::new(trajectory);
            let all_pass = match is_paper {
                true => paper_all_pass(&operators, &flows, &transform, stage)?,
                false => transform.filter(&vec![1.0; transform.component_times().len()])?,
            };
            let initial = transform.trajectory().initial();
            let rows = [lengths(&(all_pass - initial)), distance, relative];
            for (table, row) in [
                &mut errors.all_pass,
                &mut errors.bands,
                &mut errors.relative,
            ]
            .into_iter()
            .zip(&rows)
            {
                table.push_row(row.view()).expect("rows of one length");
            }
        }
        Ok::<_, Error>(errors)
    };
    let ours = measure(settings.stepping.scheme, false)?;
    let paper = measure(Scheme::Lagged, true)?;
    stage.report(1.0)?;
    Ok(Accuracy {
        steps: steps.clone(),
        edges,
        ours,
        paper,
    })
}

/// Bytes that it takes: the refined flow, two flows' bands and the tables, each twice as they grow.
fn memory(mesh: &TriangleMesh, request: &AccuracyRequest, refined: usize) -> u64 {
    let settings = Settings {
        times: None,
        steps: refined,
        accuracy: None,
        ..request.settings.clone()
    };
    let functions = 6_usize.saturating_mul(request.bands) + 8 * request.steps.len();
    decomposition_memory_of(mesh, &settings)
        .saturating_add(needs::functions(functions, mesh.vertex_count() as u64))
}

/// ∫ φ dt + T p(u(T)) + u(T) (Brokman et al. 2024, Eq. 53 for H = 1), (C, V): central differences
/// for u_tt and the trapezoidal rule give Σ φ_k whatever the nodes; p is taken at u(T).
fn paper_all_pass(
    operators: &Discretization,
    flows: &[Flowed],
    transform: &SpectralTransform,
    stage: Stage,
) -> Result<Array2<f64>> {
    let (times, trajectory) = (transform.times(), transform.trajectory());
    let last = times.len() - 1;
    let end = trajectory.combined(&vec![1.0; last]);
    // Σ φ_k = u(0) − u_N − t_N p_{N−1}, with p of the last step.
    let mut factors = vec![0.0; last];
    factors[last - 1] = times[last] / (times[last] - times[last - 1]);
    let mut shape = trajectory.combined(&factors);
    let mut first = 0;
    for Flowed { law, values } in flows {
        let channels = first..first + values.nrows();
        let part = end.slice_axis(Axis(0), channels.clone().into());
        let velocity = velocity(operators, &**law, part, stage)?;
        let mut part = shape.slice_axis_mut(Axis(0), channels.into());
        part.scaled_add(times[last], &velocity);
        first += values.nrows();
    }
    Ok(shape)
}
