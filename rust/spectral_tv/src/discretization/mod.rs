//! The operators of one mesh and what solving with them needs: built once, shared by all steps.

mod checks;
mod parts;

use std::borrow::Cow;
use std::sync::{Arc, OnceLock};

use ndarray::{Array2, ArrayView2};

pub use crate::elements::Elements;
use crate::error::Result;
use crate::memory::needs;
use crate::mesh::TriangleMesh;
use crate::monitor::{Monitor, Stage};
use crate::numbering::Numbering;
pub use crate::operators::positions;
use crate::operators::{
    self, EdgeElements, EdgeLaplacian, Gradient, LaplacianPattern, Mass, graph_of,
    invertible_masses,
};
use crate::parallel;
use crate::solver::{Cholesky, Demand, LinearSolver, Solver, Symbolic};

/// Vertices from which flows number them anew: on fewer all that a pass needs is in caches anyway.
const LARGE: usize = 30_000;

/// G, the areas A and M, and the pattern of L(w), in the metric g₀ of a mesh.
///
/// Functions are given by their values at vertices. What flows are its unknowns, N of them: those
/// values, maybe in another order, or values at edges. Gradient, masses and systems are of the unknowns.
#[derive(Debug, Clone)]
pub struct Discretization {
    gradient: Gradient,
    pattern: LaplacianPattern,
    symbolic: Symbolic,
    /// Made for flows only; deformations never ask for them.
    edges: OnceLock<EdgeLaplacian>,
    masses: Vec<f64>,
    /// c of [`Mass`].
    couplings: Vec<f64>,
    /// Where the unknowns are edges.
    on_edges: Option<Arc<EdgeElements>>,
    /// Where they are vertices in another order than the caller's.
    numbering: Option<Arc<Numbering>>,
    area: f64,
    /// The largest component of a ∇λ, 1/length.
    steepest_hat: f64,
}

impl Discretization {
    /// The operators of `mesh`.
    ///
    /// # Errors
    /// [`crate::Error::Memory`].
    pub fn new(mesh: &TriangleMesh) -> Result<Self> {
        Self::new_with(mesh, Monitor::new().whole())
    }

    /// [`Self::new`], watched: `stage` cancels it.
    ///
    /// # Errors
    /// As [`Self::new`], or [`crate::Error::Cancelled`].
    pub fn new_with(mesh: &TriangleMesh, stage: Stage) -> Result<Self> {
        require_operators(mesh, stage)?;
        let gradient = Gradient::new(mesh, stage)?;
        let masses = invertible_masses(mesh.vertex_areas());
        Self::of_parts(gradient, masses, mesh.area(), stage)
    }

    /// The operators of `mesh` for flows. On a large mesh the unknowns are numbered breadth first: passes
    /// over it then find what they need in the processor's caches. Flows take and give values at
    /// vertices, by the caller's numbers; see [`Self::unknowns`] and [`Self::values`].
    ///
    /// # Errors
    /// As [`Self::new_with`].
    pub(crate) fn for_flows(mesh: &TriangleMesh, stage: Stage) -> Result<Self> {
        match mesh.vertex_count() < LARGE {
            true => Self::new_with(mesh, stage),
            false => Self::numbered(mesh, stage),
        }
    }

    /// The same however small the mesh.
    pub(crate) fn numbered(mesh: &TriangleMesh, stage: Stage) -> Result<Self> {
        require_operators(mesh, stage)?;
        let graph = graph_of(mesh.triangles(), mesh.vertex_count(), stage)?;
        let numbering = Numbering::breadth_first(&graph, stage)?;
        let graph = numbering.renumbered(&graph, stage)?;
        let gradient = Gradient::numbered(mesh, &numbering, stage)?;
        let masses = invertible_masses(mesh.vertex_areas());
        let masses = parallel::map(&numbering.order, |vertex| masses[*vertex as usize]);
        let pattern = LaplacianPattern::of_graph(graph);
        Ok(Self {
            numbering: Some(numbering.into()),
            ..Self::of_pattern(gradient, pattern, masses, mesh.area(), stage)?
        })
    }

    /// The operators of `mesh` for flows of functions of these `elements`.
    ///
    /// # Errors
    /// As [`Self::new_with`].
    pub(crate) fn of_elements(
        mesh: &TriangleMesh,
        elements: Elements,
        stage: Stage,
    ) -> Result<Self> {
        if elements == Elements::Vertices {
            return Self::for_flows(mesh, stage);
        }
        stage.require(
            needs::edge_operators(needs::Size::of(mesh)),
            &format!("working on the edges of {} vertices", mesh.vertex_count()),
            "take a mesh of fewer vertices",
        )?;
        let of_vertices = Gradient::new(mesh, stage)?;
        let on_edges = EdgeElements::new(mesh, &of_vertices, stage)?;
        let gradient = on_edges.gradient(&of_vertices);
        drop(of_vertices);
        let masses = invertible_masses(&on_edges.areas());
        let couplings = stage.pass(|| on_edges.couplings(mesh))?;
        Ok(Self {
            couplings,
            on_edges: Some(on_edges.into()),
            ..Self::of_parts(gradient, masses, mesh.area(), stage)?
        })
    }

    fn of_parts(gradient: Gradient, masses: Vec<f64>, area: f64, stage: Stage) -> Result<Self> {
        let pattern = LaplacianPattern::new(&gradient, stage)?;
        Self::of_pattern(gradient, pattern, masses, area, stage)
    }

    fn of_pattern(
        gradient: Gradient,
        pattern: LaplacianPattern,
        masses: Vec<f64>,
        area: f64,
        stage: Stage,
    ) -> Result<Self> {
        let steepest = |face: usize| {
            let hats = gradient.hats(face);
            let components = hats.as_flattened().iter();
            components.fold(0.0_f64, |max, x| max.max(x.abs()))
        };
        let largest = || {
            parallel::largest(gradient.face_areas().len(), |faces| {
                faces.map(steepest).fold(0.0, f64::max)
            })
        };
        let steepest_hat = stage.pass(largest)?;
        Ok(Self {
            steepest_hat,
            edges: OnceLock::new(),
            gradient,
            pattern,
            symbolic: Symbolic::default(),
            masses,
            couplings: Vec::new(),
            on_edges: None,
            numbering: None,
            area,
        })
    }

    /// What functions are made of.
    pub fn elements(&self) -> Elements {
        match self.on_edges {
            None => Elements::Vertices,
            Some(_) => Elements::Edges,
        }
    }

    /// Where the unknowns are, if that is on edges.
    pub(crate) fn on_edges(&self) -> Option<&EdgeElements> {
        self.on_edges.as_deref()
    }

    /// Number of vertices, V.
    pub fn vertex_count(&self) -> usize {
        match &self.on_edges {
            None => self.masses.len(),
            Some(on_edges) => on_edges.vertex_count(),
        }
    }

    /// The unknowns, (C, N), of the function with these `values` (C, V); `None` where they are the
    /// values.
    pub(crate) fn unknowns(&self, values: ArrayView2<f64>) -> Option<Array2<f64>> {
        match (&self.on_edges, &self.numbering) {
            (Some(on_edges), _) => Some(on_edges.sample(values)),
            (None, Some(numbering)) => Some(numbering.inwards(values)),
            (None, None) => None,
        }
    }

    /// The values, (C, V), of the function with these `unknowns` (C, N). Where a vertex is in no
    /// triangle, that of `before`.
    pub(crate) fn values(&self, unknowns: Array2<f64>, before: ArrayView2<f64>) -> Array2<f64> {
        match (&self.on_edges, &self.numbering) {
            (Some(on_edges), _) => on_edges.interpolate(unknowns.view(), before),
            (None, Some(numbering)) => numbering.outwards(unknowns.view()),
            (None, None) => unknowns,
        }
    }

    /// The order of the unknowns, if they are vertices in another order than the caller's.
    pub(crate) fn numbering(&self) -> Option<&Arc<Numbering>> {
        self.numbering.as_ref()
    }

    /// TV of the function with these `values` (C, V), unit of the values × length. It is that of the
    /// unknowns too: D S f = ∇f in every triangle.
    pub fn total_variation(&self, values: ArrayView2<f64>) -> f64 {
        match self.unknowns(values) {
            None => operators::total_variation(&self.gradient, values),
            Some(unknowns) => operators::total_variation(&self.gradient, unknowns.view()),
        }
    }

    /// The gradient and the face areas.
    pub fn gradient(&self) -> &Gradient {
        &self.gradient
    }

    /// The pattern of weighted Laplacians.
    pub(crate) fn pattern(&self) -> &LaplacianPattern {
        &self.pattern
    }

    /// Makes [`Self::edges`], if they are not made yet.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub(crate) fn prepare_edges(&self, stage: Stage) -> Result<()> {
        if self.edges.get().is_none() {
            let edges = EdgeLaplacian::new(&self.gradient, &self.pattern, stage)?;
            // Whoever was faster has made the same.
            let _ = self.edges.set(edges);
        }
        Ok(())
    }

    /// Weighted Laplacians by their edges.
    ///
    /// # Panics
    /// Without [`Self::prepare_edges`].
    pub(crate) fn edges(&self) -> &EdgeLaplacian {
        self.edges.get().expect("prepared before")
    }

    /// A solver of systems with matrices of the pattern.
    ///
    /// # Errors
    /// As [`LinearSolver::new`].
    pub(crate) fn solver(
        &self,
        choice: Solver,
        demand: Demand,
        stage: Stage,
    ) -> Result<LinearSolver> {
        LinearSolver::new(self.pattern.graph(), &self.symbolic, choice, demand, stage)
    }

    /// Which solver `choice` means for what is demanded of matrices of the pattern.
    ///
    /// # Errors
    /// As [`Solver::chosen`].
    pub(crate) fn chosen(&self, choice: Solver, demand: Demand) -> Result<Solver> {
        choice.chosen(&self.pattern.zeros(), &self.symbolic, demand)
    }

    /// Room for the factor of a matrix of the pattern.
    ///
    /// # Errors
    /// As [`Cholesky::new`].
    pub(crate) fn cholesky(&self, stage: Stage) -> Result<Cholesky> {
        Cholesky::new(&self.pattern.zeros(), &self.symbolic, stage)
    }

    /// H: the mass of the unknowns, length².
    pub(crate) fn mass(&self) -> Mass<'_> {
        Mass::coupled(&self.masses, &self.couplings, self.gradient.triangles())
    }

    /// M: the lumped mass of every unknown, length², positive everywhere.
    pub fn masses(&self) -> &[f64] {
        &self.masses
    }

    /// The same by the caller's numbers, where the unknowns are at vertices.
    pub(crate) fn vertex_masses(&self) -> Cow<'_, [f64]> {
        match &self.numbering {
            None => (&*self.masses).into(),
            Some(numbering) => {
                let places = &numbering.places[..];
                parallel::map(places, |place| self.masses[*place as usize]).into()
            }
        }
    }

    /// Area of the surface, length².
    pub fn area(&self) -> f64 {
        self.area
    }
}

/// Has the operators of `mesh` granted their memory.
fn require_operators(mesh: &TriangleMesh, stage: Stage) -> Result<()> {
    stage.require(
        needs::operators(needs::Size::of(mesh)),
        &format!("working on {} vertices", mesh.vertex_count()),
        "take a mesh of fewer vertices",
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;

    #[test]
    fn preparations_end_when_cancelled() {
        let vertices = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]];
        let mesh = TriangleMesh::new(vertices, &[[0, 1, 2]]).unwrap();
        let operators = Discretization::new(&mesh).unwrap();
        let monitor = Monitor::new();
        monitor.cancel();
        let outcome = operators.prepare_edges(monitor.whole());
        assert!(matches!(outcome, Err(Error::Cancelled)));
        let outcome = Discretization::new_with(&mesh, monitor.whole());
        assert!(matches!(outcome, Err(Error::Cancelled)));
    }
}
