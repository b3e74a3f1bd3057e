//! The flow of a function on a mesh.

use ndarray::{Array2, ArrayView2};

use crate::discretization::{Discretization, Elements};
use crate::error::Result;
use crate::flow::law::Law;
use crate::flow::stepping::Stepping;
use crate::flow::trajectory::Trajectory;
use crate::memory::needs;
use crate::mesh::TriangleMesh;
use crate::monitor::{Monitor, Stage};
use crate::named::named;

named! {
    /// The law by which a function flows, in the metric of the mesh.
    pub enum Operator: "operator" {
        /// u_t ∈ −∂NETV(u) (Brokman et al. 2024, Eq. 20), channels coupled.
        #[default]
        TotalVariation = "tv" => {
            let law = super::total_variation::TotalVariation::default();
            Ok(Box::new(law.starting_at(operators, start)?))
        },
        /// u_t = Δu (Eq. 12).
        Heat = "heat" => Ok(Box::new(super::heat::Heat)),
    }
    /// The law for a function that is `start`, (C, V), at first.
    fn law(self, operators: &Discretization, start: ArrayView2<f64>) -> Result<Box<dyn Law>>;
}

/// Flows a function with the `values` (C, V) on `mesh` through `times`, which increase from 0: in the
/// unit of the values × length for TV, length² for heat.
///
/// It is made of `elements` meanwhile, see [`Elements::suiting`]. With `Elements::Edges` the steps go on
/// from means along edges, and the states that are handed back are functions on vertices which have
/// the same mean; TV is that of the means.
///
/// ```
/// use spectral_tv::discretization::Elements;
/// use spectral_tv::flow::{Operator, Stepping, flow};
/// use spectral_tv::ndarray::array;
/// use spectral_tv::spectral::SpectralTransform;
///
/// # use spectral_tv::mesh::TriangleMesh;
/// # let vertices = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0.3, 0.3, 1.]];
/// # let triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// # let mesh = TriangleMesh::new(vertices, &triangles)?;
/// let height = array![[0.0, 0.0, 0.0, 1.0]];
/// let times = [0.0, 0.01, 0.03, 0.1];
/// let (law, stepping) = (Operator::TotalVariation, Stepping::default());
/// let flow = flow(&mesh, height, &times, law, Elements::Vertices, stepping)?;
/// assert!(flow.total_variation.is_sorted_by(|now, later| now >= later));
/// assert_eq!(SpectralTransform::new(flow).component_times(), [0.01, 0.03]);
/// # Ok::<(), spectral_tv::Error>(())
/// ```
///
/// # Errors
/// As [`Stepping::run`].
pub fn flow(
    mesh: &TriangleMesh,
    values: Array2<f64>,
    times: &[f64],
    operator: Operator,
    elements: Elements,
    stepping: Stepping,
) -> Result<Trajectory> {
    let monitor = Monitor::new();
    let stage = monitor.whole();
    flow_with(mesh, values, times, operator, elements, stepping, stage)
}

/// [`flow`], watched: `stage` tells how far it is, and cancels it.
///
/// # Errors
/// As [`flow`], or [`crate::Error::Cancelled`].
pub fn flow_with(
    mesh: &TriangleMesh,
    values: Array2<f64>,
    times: &[f64],
    operator: Operator,
    elements: Elements,
    stepping: Stepping,
    stage: Stage,
) -> Result<Trajectory> {
    stepping.check()?;
    stepping.require(needs::Size::of(mesh), values.dim(), elements, times, stage)?;
    let operators = Discretization::of_elements(mesh, elements, stage)?;
    let law = operator.law(&operators, values.view())?;
    stepping.run_with(&operators, &*law, values, times, stage)
}
