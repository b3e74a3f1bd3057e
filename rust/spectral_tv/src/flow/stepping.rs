//! How the steps of a flow are taken.

use ndarray::Array2;

use crate::discretization::{Discretization, Elements};
use crate::error::{ArgumentError, Result};
use crate::flow::law::Law;
use crate::flow::proximal::proximal_flow;
use crate::flow::semi_implicit::{Weights, semi_implicit_flow};
use crate::flow::trajectory::Trajectory;
use crate::memory::needs;
use crate::minimization::check_tolerance;
use crate::monitor::{Monitor, Stage};
use crate::named::{Named, named};
use crate::solver::{Demand, Solver};

named! {
    /// How a step takes its weights.
    pub enum Scheme: "scheme" {
        /// Extrapolated to the end of the step, with BDF2 and corrections by the same matrix: a sixth of
        /// the lagged error for a third more time. TV of single functions takes two iterations of
        /// Newton's method in each step instead.
        #[default]
        Extrapolated = "extrapolated",
        /// At the last state, with backward Euler: the paper's step.
        Lagged = "lagged",
        /// Every step a proximal step, to a duality gap. For TV flows only.
        Exact = "exact",
    }
}

/// How the steps of a flow are taken, and their systems solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stepping {
    /// How steps take their weights.
    pub scheme: Scheme,
    /// Duality gap of exact steps relative to Δt TV, in (0, 1).
    pub tolerance: f64,
    /// How linear systems are solved.
    pub solver: Solver,
}

impl Default for Stepping {
    fn default() -> Self {
        Self {
            scheme: Scheme::default(),
            tolerance: 1e-3,
            solver: Solver::default(),
        }
    }
}

impl Stepping {
    /// The weights of steps that solve one system; `None` for exact steps.
    fn weights(self) -> Option<Weights> {
        match self.scheme {
            Scheme::Extrapolated => Some(Weights::Extrapolated),
            Scheme::Lagged => Some(Weights::Lagged),
            Scheme::Exact => None,
        }
    }

    /// What a flow of so many channels takes each matrix for; `None` where it makes its own.
    pub(crate) fn demand(self, channels: usize) -> Option<Demand> {
        self.weights().map(|weights| weights.demand(channels))
    }

    /// How systems of a flow of so many channels are solved.
    pub(crate) fn solved(self, vertices: usize, channels: usize) -> needs::Solved {
        let solved = |demand| self.solver.solved(vertices, demand);
        self.demand(channels).map_or(needs::Solved::Exactly, solved)
    }

    /// Refuses a tolerance that no step can have, even where it is of no account.
    ///
    /// # Errors
    /// If it is not in (0, 1).
    pub fn check(self) -> Result<()> {
        check_tolerance(self.tolerance)
    }

    /// Runs `law` from `values` (C, V) through `times`.
    ///
    /// ```
    /// use spectral_tv::discretization::{Discretization, positions};
    /// use spectral_tv::flow::{Heat, Stepping};
    ///
    /// # use spectral_tv::mesh::TriangleMesh;
    /// # let vertices = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0.3, 0.3, 1.]];
    /// # let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    /// # let mesh = TriangleMesh::new(vertices, &triangles)?;
    /// let operators = Discretization::new(&mesh)?;
    /// let times = [0.0, 0.01, 0.02];
    /// let flow = Stepping::default().run(&operators, &Heat, positions(&mesh), &times)?;
    /// assert_eq!(flow.states().count(), 3);
    /// # Ok::<(), spectral_tv::Error>(())
    /// ```
    ///
    /// # Errors
    /// If the times do not increase from 0, a value is not finite, exact steps are asked for where
    /// no step minimises TV, or a system cannot be solved; [`crate::Error::Memory`] at once if the flow
    /// does not fit.
    pub fn run(
        self,
        operators: &Discretization,
        law: &dyn Law,
        values: Array2<f64>,
        times: &[f64],
    ) -> Result<Trajectory> {
        self.run_with(operators, law, values, times, Monitor::new().whole())
    }

    /// [`Self::run`], watched: `stage` tells how far it is, and cancels it.
    ///
    /// # Errors
    /// As [`Self::run`], or [`crate::Error::Cancelled`].
    pub fn run_with(
        self,
        operators: &Discretization,
        law: &dyn Law,
        values: Array2<f64>,
        times: &[f64],
        stage: Stage,
    ) -> Result<Trajectory> {
        let triangles = operators.gradient().triangles().len();
        let size = needs::Size::new(operators.vertex_count(), triangles);
        let elements = operators.elements();
        self.require(size, values.dim(), elements, times, stage)?;
        if elements == Elements::Edges && self.scheme != Scheme::Exact {
            let reason = format!(
                "steps on {} are exact ones; take the scheme {:?}",
                elements.name(),
                Scheme::Exact.name()
            );
            return Err(ArgumentError::inapplicable(Elements::ARGUMENT, reason).into());
        }
        match self.weights() {
            Some(weights) => {
                semi_implicit_flow(operators, law, weights, values, times, self.solver, stage)
            }
            None if law.is_total_variation() => {
                proximal_flow(operators, self.tolerance, values, times, stage)
            }
            None => {
                let reason = "exact steps exist for total-variation flows only";
                Err(ArgumentError::inapplicable("scheme", reason).into())
            }
        }
    }

    /// Has a flow of values (C, V) granted its memory.
    ///
    /// # Errors
    /// [`crate::Error::Memory`].
    pub(crate) fn require(
        self,
        size: needs::Size,
        (channels, vertices): (usize, usize),
        elements: Elements,
        times: &[f64],
        stage: Stage,
    ) -> Result<()> {
        let steps = times.len().saturating_sub(1);
        let solved = self.solved(vertices, channels);
        let needed = match elements {
            Elements::Vertices => needs::flow(size, channels, steps, solved),
            Elements::Edges => needs::edge_flow(size, channels, steps),
        };
        stage.require(
            needed,
            &format!("a flow of {steps} steps on {vertices} vertices"),
            "take fewer steps or vertices",
        )
    }
}
