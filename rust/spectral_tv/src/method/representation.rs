//! The functions that a method flows in place of a shape, and by which laws.

use ndarray::{Array2, Axis};

use crate::error::{Error, Result};
use crate::flow::{ConformalLaplace, Heat, Law, TotalVariation};
use crate::mesh::TriangleMesh;
use crate::method::{Displacement, Method};
use crate::monitor::Stage;
use crate::operators::{Discretization, positions};
use crate::solver::Solver;

/// One function, and the law of its flow.
pub(super) struct Flowed {
    /// What drives it.
    pub law: Box<dyn Law>,
    /// The function f, (C, V).
    pub values: Array2<f64>,
}

/// A shape as functions to flow.
pub(super) struct Representation {
    /// The functions; several flow each by itself.
    pub flows: Vec<Flowed>,
    /// How M3's scalars become shapes; `None` where positions are flowed.
    pub displacement: Option<Displacement>,
}

impl Representation {
    /// The representation of `mesh` for `method`, M3's base made by `solver`.
    ///
    /// # Errors
    /// If a setting of the method makes no sense or the method has no flow; or as
    /// [`crate::method::Base::shape`] and [`Displacement::between`].
    pub fn new(
        mesh: &TriangleMesh,
        operators: &Discretization,
        method: &Method,
        solver: Solver,
        stage: Stage,
    ) -> Result<Self> {
        let tv = |values: Array2<f64>| -> Result<Flowed> {
            let law = Box::new(TotalVariation::starting_at(operators, values.view())?);
            Ok(Flowed { law, values })
        };
        let shape = positions(mesh);
        let mut displacement = None;
        let flows = match method {
            Method::Heat => vec![Flowed {
                law: Box::new(Heat),
                values: shape,
            }],
            Method::Naive => {
                let channels = shape.axis_chunks_iter(Axis(0), 1);
                channels
                    .map(|channel| tv(channel.to_owned()))
                    .collect::<Result<_>>()?
            }
            Method::ShapeTv => vec![tv(shape)?],
            Method::ConformalLaplace { p } => vec![Flowed {
                law: Box::new(ConformalLaplace::new(mesh, operators, *p)?),
                values: shape,
            }],
            Method::DirectionalTv { base } => {
                let base = base.shape(mesh, operators, solver, stage)?;
                let found = Displacement::between(mesh, operators, base, solver, stage)?;
                let flowed = tv(found.distance.clone())?;
                displacement = Some(found);
                vec![flowed]
            }
            Method::LaplaceBeltrami { .. } | Method::Displacement { .. } => {
                let message = "the methods \"lb\" and \"displacement\" take no time steps";
                return Err(Error::Argument(message.into()));
            }
        };
        Ok(Self {
            flows,
            displacement,
        })
    }
}
