//! Flows of any function, the conformal flow, eigenpairs.

use arbitrary::Arbitrary;
use ndarray::Array2;
use spectral_tv::discretization::Discretization;
use spectral_tv::flow::{
    ConformalLaplace, Eigenpairs, Heat, Law, Stepping, TotalVariation,
    conformal_mean_curvature_flow,
};
use spectral_tv::mesh::TriangleMesh;
use spectral_tv::solver::Solver;
use spectral_tv::spectral::SpectralTransform;

use crate::number::{number, numbers, times};
use crate::scales::{solver, stepping};
use crate::{assert_finite, largest, unless_refused};

/// The flow of any function by any law.
#[derive(Debug, Arbitrary)]
pub struct Flow {
    /// Repeated to fill all channels.
    #[arbitrary(with = numbers)]
    values: Vec<f64>,
    channels: u8,
    #[arbitrary(with = times)]
    times: Vec<f64>,
    are_times_relative: bool,
    law: u8,
    #[arbitrary(with = stepping)]
    stepping: Stepping,
    #[arbitrary(with = numbers)]
    weights: Vec<f64>,
}

impl Flow {
    pub fn run(&self, mesh: &TriangleMesh) {
        let operators = unless_refused(Discretization::new(mesh)).expect("of any mesh");
        let dimensions = (usize::from(self.channels % 5), mesh.vertex_count());
        let mut filling = self.values.iter().copied().cycle();
        let values = Array2::from_shape_simple_fn(dimensions, || filling.next().unwrap_or(1.0));
        let law: Option<Box<dyn Law>> = match self.law % 6 {
            0 => Some(Box::new(Heat)),
            1 => unless_refused(ConformalLaplace::new(&operators, 3))
                .map(|law| Box::new(law) as Box<dyn Law>),
            _ => unless_refused(TotalVariation::default().starting_at(&operators, values.view()))
                .map(|law| Box::new(law) as Box<dyn Law>),
        };
        // The conformal law is for positions.
        let Some(law) = law.filter(|law| !law.moves_masses() || dimensions.0 == 3) else {
            return;
        };
        let scale = if self.are_times_relative {
            mesh.area()
        } else {
            1.0
        };
        let times: Vec<f64> = self.times.iter().map(|time| scale * time).collect();
        let outcome = self.stepping.run(&operators, &*law, values.clone(), &times);
        let Some(flow) = unless_refused(outcome) else {
            return;
        };
        assert_finite("TV", &flow.total_variation);
        assert_finite("gaps", &flow.gaps);
        for state in flow.states() {
            assert_finite("a state", &state);
        }
        if let Some(mean) = unless_refused(flow.mean(&self.weights, operators.masses())) {
            assert_finite("mean", &mean);
        }
        let transform = SpectralTransform::new(flow);
        let ones = vec![1.0; transform.component_times().len()];
        let whole = transform.filter(&ones).expect("a gain each");
        let parts = (0..ones.len()).map(|k| largest(&transform.component(k)));
        let size = parts.fold(
            largest(&values).max(largest(&transform.residual())),
            f64::max,
        );
        let error = largest(&(whole - values));
        assert!(error <= 1e-12 * size, "all-pass: {error:e} of {size:e}");
    }
}

/// Conformalized mean curvature flow.
#[derive(Debug, Arbitrary)]
pub struct ConformalFlow {
    #[arbitrary(with = number)]
    duration: f64,
    is_relative: bool,
    steps: u8,
    #[arbitrary(with = solver)]
    solver: Solver,
}

impl ConformalFlow {
    pub fn run(&self, mesh: &TriangleMesh) {
        let operators = unless_refused(Discretization::new(mesh)).expect("of any mesh");
        let duration = self.duration * if self.is_relative { mesh.area() } else { 1.0 };
        let steps = usize::from(self.steps % 8);
        let solver = self.solver;
        let flow = conformal_mean_curvature_flow(mesh, &operators, duration, steps, solver);
        if let Some(shape) = unless_refused(flow) {
            assert_finite("shape", &shape);
        }
    }
}

/// Some of the lowest eigenpairs.
#[derive(Debug, Arbitrary)]
pub struct FewEigenpairs {
    count: u8,
}

impl FewEigenpairs {
    pub fn run(&self, mesh: &TriangleMesh) {
        let operators = unless_refused(Discretization::new(mesh)).expect("of any mesh");
        let count = usize::from(self.count % 50);
        let Some(pairs) = unless_refused(Eigenpairs::lowest(mesh, &operators, count)) else {
            return;
        };
        assert_eq!(pairs.eigenvalues.len(), count.min(mesh.vertex_count()));
        assert_finite("eigenvalues", &pairs.eigenvalues);
        assert_finite("eigenfunctions", &pairs.eigenfunctions);
    }
}
