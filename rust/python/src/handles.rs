//! What is constrained, as it came from Python.

use pyo3::prelude::*;
use spectral_tv::deformation::Constraints;
use spectral_tv::memory::needs;
use spectral_tv::monitor::Stage;
use spectral_tv::posing;

use crate::arrays::{self, Vertices};
use crate::error::Failure;
use crate::job::guarded;
use crate::mesh::Mesh;
use crate::pickling::{Parts, Writer};

/// What is constrained, as it came from Python, and how firmly.
#[derive(Clone)]
pub struct Handles {
    pub indices: Vec<i64>,
    pub weights: Option<Vec<f64>>,
}

impl Handles {
    pub fn new(
        mesh: &Mesh,
        indices: &Bound<'_, PyAny>,
        weights: Option<&Bound<'_, PyAny>>,
    ) -> Result<Self, Failure> {
        let indices = match arrays::vertices("indices", indices, mesh.inner.vertex_count())? {
            Vertices::Indices(indices) => indices,
            Vertices::Mask(mask) => {
                let places = (0_i64..).zip(&mask);
                places
                    .filter_map(|(place, &is_meant)| is_meant.then_some(place))
                    .collect()
            }
        };
        let weights = match weights {
            Some(weights) => Some(arrays::list("weights", weights)?),
            None => None,
        };
        Ok(Self { indices, weights })
    }

    /// What a deformation is held by.
    pub fn constraints(&self, py: Python<'_>, mesh: &Mesh) -> Result<Constraints, Failure> {
        let weights = self.weights.as_deref();
        guarded(py, |stage| {
            claim(mesh, stage)?;
            Constraints::new(&mesh.inner, &self.indices, weights)
        })
    }

    /// What a pose is held by, with the bodies that turn freely.
    pub fn turning(
        &self,
        py: Python<'_>,
        mesh: &Mesh,
        bodies: Option<&[i64]>,
    ) -> Result<posing::Handles, Failure> {
        let weights = self.weights.as_deref();
        guarded(py, |stage| {
            claim(mesh, stage)?;
            posing::Handles::new(&mesh.inner, &self.indices, weights, bodies)
        })
    }

    pub fn write(&self, parts: &Writer<'_>) -> Result<(), Failure> {
        parts.list("indices", &self.indices)?;
        match &self.weights {
            Some(weights) => parts.list("weights", weights),
            None => parts.value("weights", None::<()>),
        }
    }

    pub fn read(parts: &Parts<'_>) -> Result<Self, Failure> {
        let weights = match parts.optional("weights")? {
            Some(weights) => Some(arrays::list("weights", &weights)?),
            None => None,
        };
        Ok(Self {
            indices: parts.indices("indices")?,
            weights,
        })
    }
}

/// Has the search for what is held granted the memory it takes.
fn claim(mesh: &Mesh, stage: Stage) -> spectral_tv::Result<()> {
    let needed = needs::solutions(needs::Size::of(&mesh.inner), 0);
    stage.claim(
        needed,
        "finding what is held",
        "take a mesh of fewer vertices",
    )
}
