//! The functions that a method flows in place of a shape, and by which laws.

use ndarray::{Array2, Axis};

use crate::discretization::Discretization;
use crate::error::{ArgumentError, Error, Result};
use crate::flow::{ConformalLaplace, Heat, Law};
use crate::mesh::TriangleMesh;
use crate::method::facts::named_where;
use crate::method::{Displacement, Flowing, Method, Metric, Settings};
use crate::monitor::Stage;
use crate::operators::positions;

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
    /// The base with its operators, where it is along it that M3 flows.
    pub along: Option<(TriangleMesh, Discretization)>,
}

impl Representation {
    /// The representation of `mesh` for the method and the flow of `settings`.
    ///
    /// # Errors
    /// If a setting of the method makes no sense or the method has no flow; or as
    /// [`crate::method::Base::shape`] and [`Displacement::between`].
    pub fn new(
        mesh: &TriangleMesh,
        operators: &Discretization,
        settings: &Settings,
        stage: Stage,
    ) -> Result<Self> {
        let tv_on = |operators: &Discretization, values: Array2<f64>| -> Result<Flowed> {
            let law = settings.total_variation;
            let law = Box::new(law.starting_at(operators, values.view())?);
            Ok(Flowed { law, values })
        };
        let tv = |values: Array2<f64>| tv_on(operators, values);
        let shape = positions(mesh);
        let mut displacement = None;
        let mut along = None;
        let flows = match settings.method {
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
            Method::ConformalLaplace => vec![Flowed {
                law: Box::new(ConformalLaplace::new(operators, settings.p)?),
                values: shape,
            }],
            Method::DirectionalTv => {
                // What is prepared for the flow serves the base and the signs, too.
                let channels = match settings.displacement {
                    Flowing::Scalar => 1,
                    Flowing::Vector => 3,
                };
                let solver = settings.stepping.solver;
                let solver = match settings.stepping.demand(channels) {
                    Some(demand) => operators.chosen(solver, demand)?,
                    None => solver,
                };
                let duration = settings.base_duration(mesh.area());
                let base = settings
                    .base
                    .shape(mesh, operators, duration, solver, stage)?;
                let (found, values) = match settings.displacement {
                    Flowing::Scalar => Displacement::between(mesh, operators, base, solver, stage)?,
                    Flowing::Vector => Displacement::vector(mesh, base),
                };
                let flowed = match settings.metric {
                    Metric::Surface => tv(values)?,
                    Metric::Base => {
                        let base = with_shape(mesh, &found.base)?;
                        let operators = Discretization::for_flows(&base, stage)?;
                        let flowed = tv_on(&operators, values)?;
                        along = Some((base, operators));
                        flowed
                    }
                };
                displacement = Some(found);
                vec![flowed]
            }
            Method::LaplaceBeltrami | Method::Displacement => return Err(no_time_steps()),
        };
        Ok(Self {
            flows,
            displacement,
            along,
        })
    }
}

/// What a method is refused with where one is asked for that flows in steps.
pub(super) fn no_time_steps() -> Error {
    let methods = named_where(|method| !method.facts().takes_steps(), "and");
    ArgumentError::inapplicable("steps", format!("{methods} take no time steps")).into()
}

/// The triangles of `mesh` between the positions `shape` (3, V).
fn with_shape(mesh: &TriangleMesh, shape: &Array2<f64>) -> Result<TriangleMesh> {
    let vertices = shape.columns().into_iter().map(|p| [p[0], p[1], p[2]]);
    let triangles: Vec<_> = mesh.triangles().iter().map(|t| t.map(i64::from)).collect();
    TriangleMesh::new(vertices.collect(), &triangles)
}
