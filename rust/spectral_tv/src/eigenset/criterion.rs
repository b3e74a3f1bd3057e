//! The test: eigenvalue, decay and perimeters.

use ndarray::Array2;

use crate::discretization::{Discretization, Elements};
use crate::eigenset::decay::Decay;
use crate::eigenset::diffusion::mean_edge;
use crate::eigenset::perimeter::Perimeter;
use crate::eigenset::supersets::{members, supersets};
use crate::error::{ArgumentError, Result};
use crate::flow::proximal_flow;
use crate::memory::needs;
use crate::mesh::TriangleMesh;
use crate::monitor::{Monitor, Stage};

/// Steps of the flow, and how far it goes, in lifetimes of an eigenset.
const STEPS: usize = 24;
const LIFETIMES: f64 = 1.2;
/// Duality gap of its steps.
const GAP: f64 = 1e-3;
/// Supersets have to leave this share of the surface.
const LEAST_REST: f64 = 1e-3;
/// What of the surface's progress the flow takes.
const FLOW_SHARE: f64 = 0.5;

/// What a set C looks like as an eigenset of NETV (Brokman et al. 2024).
#[derive(Debug, Clone)]
pub struct EigensetTest {
    /// |C|, length².
    pub area: f64,
    /// per(C), length.
    pub perimeter: f64,
    /// The rate of decay: what λ is found to be, 1/length.
    pub rate: f64,
    /// R² of the decay as a straight line.
    pub straightness: f64,
    /// The largest relative distance from a function with one value on C and one off it, while
    /// much of it is left.
    pub spread: f64,
    /// t_k, N + 1.
    pub times: Vec<f64>,
    /// The median on C of ψ = χ_C − β χ_{M∖C} under the flow at these times: 1 − λt in theory.
    pub values: Vec<f64>,
    /// The least per(D)/|M∖D| of the supersets D ⊃ C that were tried, relative to per(C)/|M∖C|;
    /// not below 1 for an eigenset, but for discretization.
    pub perimeter_ratio: f64,
    /// The superset of that ratio, V.
    pub superset: Vec<bool>,
}

impl EigensetTest {
    /// λ = per(C)/|C|, 1/length.
    pub fn eigenvalue(&self) -> f64 {
        self.perimeter / self.area
    }

    /// Whether C is a locally minimal perimeter set as far as was tried; 1 % is left to
    /// discretization.
    pub fn has_minimal_perimeter(&self) -> bool {
        self.perimeter_ratio >= 0.99
    }

    /// Whether all of it speaks for an eigenset: the perimeter, a straight decay (R² of 0.999) at
    /// λ (within 15 %) in which C and its complement keep one value each (but for 0.2: the
    /// triangles that the boundary runs through).
    pub fn is_eigenset(&self) -> bool {
        self.has_minimal_perimeter()
            && self.straightness >= 0.999
            && self.spread <= 0.2
            && (self.rate / self.eigenvalue() - 1.0).abs() <= 0.15
    }
}

/// Tests whether the `set` (V) is an eigenset of `mesh`.
///
/// Parts of the mesh that are wholly in the set or wholly outside are left out: nothing happens
/// there.
///
/// ```
/// use spectral_tv::eigenset::eigenset_test;
///
/// # use spectral_tv::mesh::TriangleMesh;
/// # let vertices = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0.3, 0.3, 1.]];
/// # let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// # let mesh = TriangleMesh::new(vertices, &triangles)?;
/// let found = eigenset_test(&mesh, &[false, false, false, true])?;
/// assert!(found.eigenvalue() > 0.0);
/// assert!(found.superset[3]);
/// # Ok::<(), spectral_tv::Error>(())
/// ```
///
/// # Errors
/// If there is not one value per vertex, the set has no boundary, memory does not suffice, or a
/// system cannot be solved.
pub fn eigenset_test(mesh: &TriangleMesh, set: &[bool]) -> Result<EigensetTest> {
    eigenset_test_with(mesh, set, Elements::Edges, Monitor::new().whole())
}

/// [`eigenset_test`] with the flow on these `elements`, watched: `stage` tells how far it is, and
/// cancels it. Perimeters are those of functions on edges in any case.
///
/// # Errors
/// As [`eigenset_test`], or [`crate::Error::Cancelled`].
pub fn eigenset_test_with(
    mesh: &TriangleMesh,
    set: &[bool],
    elements: Elements,
    stage: Stage,
) -> Result<EigensetTest> {
    let areas = mesh.vertex_areas();
    if set.len() != areas.len() {
        return Err(ArgumentError::count(
            "set",
            format!("must have one value per vertex ({})", areas.len()),
            set.len(),
        )
        .into());
    }
    let components = mesh.connected_components();
    let (inside, outside) = areas_by_component(&components, set, areas);
    let is_parted = |v: usize| {
        let component = components[v] as usize;
        inside[component] > 0.0 && outside[component] > 0.0
    };
    let surface: Vec<bool> = (0..set.len()).map(is_parted).collect();
    let set: Vec<bool> = (0..set.len()).map(|v| set[v] && surface[v]).collect();
    let area_of = |set: &[bool]| members(set).map(|v| areas[v]).sum::<f64>();
    let (area, whole) = (area_of(&set), area_of(&surface));
    if area <= 0.0 {
        return Err(ArgumentError::empty(
            "set",
            "the set has no boundary: every part of the mesh is wholly in it or outside",
        )
        .into());
    }
    let size = needs::Size::of(mesh);
    // Beside the flow, the supersets and what diffuses them.
    let flow_needs = match elements {
        Elements::Vertices => needs::flow(size, 1, STEPS, needs::Solved::Exactly),
        Elements::Edges => needs::edge_flow(size, 1, STEPS),
    };
    stage.require(
        flow_needs.saturating_add(needs::solutions(size, 0)),
        &format!("testing a set of {} vertices", set.len()),
        "take a mesh of fewer vertices",
    )?;
    stage.report(0.0)?;
    let operators = Discretization::new_with(mesh, stage)?;
    let on_edges = Discretization::of_elements(mesh, Elements::Edges, stage)?;
    let perimeter = Perimeter::new(mesh, &on_edges);
    let length = perimeter.of(&set, stage)?;
    // ψ, with zero mean on every part, so that it vanishes.
    let psi = Array2::from_shape_fn((1, set.len()), |(_, v)| {
        let component = components[v] as usize;
        match (surface[v], set[v]) {
            (false, _) => 0.0,
            (true, true) => 1.0,
            (true, false) => -inside[component] / outside[component],
        }
    });
    let lifetime = area / length;
    let time = |k: usize| LIFETIMES * lifetime * k as f64 / STEPS as f64;
    let times: Vec<f64> = (0..=STEPS).map(time).collect();
    let flowing = match elements {
        Elements::Vertices => &operators,
        Elements::Edges => &on_edges,
    };
    let flow = proximal_flow(flowing, GAP, psi, &times, stage.stage(0.0, FLOW_SHARE))?;
    // The set, and what is outside of it of every component.
    let region = |v: usize| {
        if set[v] {
            0
        } else {
            1 + components[v] as usize
        }
    };
    let regions: Vec<usize> = (0..set.len()).map(region).collect();
    let decay = Decay::of(&flow, &regions, operators.masses());

    let stage = stage.stage(FLOW_SHARE, 1.0);
    let candidates = supersets(
        &operators,
        &set,
        &surface,
        &flow,
        mean_edge(mesh),
        stage.stage(0.0, 0.4),
    )?;
    let (mut least, mut superset) = (f64::INFINITY, set.clone());
    let own = length / (whole - area);
    for (k, candidate) in candidates.iter().enumerate() {
        stage.report(0.4 + 0.6 * k as f64 / candidates.len() as f64)?;
        let rest = whole - area_of(candidate);
        if rest < LEAST_REST * whole {
            continue;
        }
        let ratio = perimeter.of(candidate, stage)? / rest / own;
        if ratio < least {
            (least, superset) = (ratio, candidate.clone());
        }
    }
    stage.report(1.0)?;
    Ok(EigensetTest {
        area,
        perimeter: length,
        rate: decay.rate,
        straightness: decay.straightness,
        spread: decay.spread,
        times,
        values: decay.values,
        perimeter_ratio: least,
        superset,
    })
}

/// Areas of the set and of its complement in every component.
fn areas_by_component(components: &[u32], set: &[bool], areas: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let (mut inside, mut outside) = (vec![0.0; set.len()], vec![0.0; set.len()]);
    for ((&component, &is_inside), area) in components.iter().zip(set).zip(areas) {
        match is_inside {
            true => inside[component as usize] += area,
            false => outside[component as usize] += area,
        }
    }
    (inside, outside)
}
