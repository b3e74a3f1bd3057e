//! A shape split into scales.

use ndarray::Array2;

use crate::error::{ArgumentError, Result, unusable_values};
use crate::method::Displacement;
use crate::monitor::Stage;
use crate::spectral::SpectralTransform;

/// The spectral components of a shape, as displacements of its vertices.
#[derive(Debug, Clone)]
pub struct Decomposition {
    transform: SpectralTransform,
    /// How M3's scalars become shapes; `None` where the positions themselves were flowed.
    displacement: Option<Displacement>,
    spectrum: Vec<f64>,
    vertex_areas: Vec<f64>,
}

impl Decomposition {
    /// Puts together a transform and, for M3, the representation of the shape it is of.
    ///
    /// # Errors
    /// [`crate::Error::Cancelled`].
    pub(super) fn new(
        transform: SpectralTransform,
        displacement: Option<Displacement>,
        vertex_areas: &[f64],
        stage: Stage,
    ) -> Result<Self> {
        Ok(Self {
            spectrum: transform.spectrum_with(vertex_areas, stage)?,
            transform,
            displacement,
            vertex_areas: vertex_areas.to_vec(),
        })
    }

    /// A decomposition from the parts of another: its transform, the base and the direction (3, V)
    /// of M3, the spectrum, N − 1, and the areas of the vertices, V.
    ///
    /// # Errors
    /// If shapes do not go together, or a number is not finite.
    pub fn restored(
        transform: SpectralTransform,
        base_and_direction: Option<(Array2<f64>, Array2<f64>)>,
        spectrum: Vec<f64>,
        vertex_areas: Vec<f64>,
    ) -> Result<Self> {
        let trajectory = transform.trajectory();
        let (channels, vertices) = trajectory.initial().dim();
        let displacement = base_and_direction.map(|(base, direction)| Displacement {
            base,
            direction,
            distance: trajectory.initial().to_owned(),
        });
        let has_shapes = match &displacement {
            None => channels == 3,
            Some(Displacement {
                base, direction, ..
            }) => channels == 1 && [base.dim(), direction.dim()] == [(3, vertices); 2],
        };
        let has_counts =
            spectrum.len() == transform.component_times().len() && vertex_areas.len() == vertices;
        if !has_shapes || !has_counts {
            let message = "the parts of the decomposition have shapes that do not go together";
            return Err(ArgumentError::contradiction(
                "transform",
                &["displacement", "spectrum"],
                message,
            )
            .into());
        }
        let is_whole = displacement.iter().all(|found| {
            let parts = [found.base.view(), found.direction.view()];
            parts
                .into_iter()
                .all(|part| unusable_values(part).is_none())
        });
        let mut numbers = spectrum.iter().chain(&vertex_areas);
        if !is_whole || !numbers.all(|number| *number >= 0.0 && number.is_finite()) {
            let message = "the decomposition has numbers that are not finite, or out of range";
            return Err(
                ArgumentError::contradiction("displacement", &["spectrum"], message).into(),
            );
        }
        Ok(Self {
            transform,
            displacement,
            spectrum,
            vertex_areas,
        })
    }

    /// How M3's scalars become shapes; `None` where the positions themselves were flowed.
    pub fn displacement(&self) -> Option<&Displacement> {
        self.displacement.as_ref()
    }

    /// Areas of the vertices of the shape, V, length².
    pub fn vertex_areas(&self) -> &[f64] {
        &self.vertex_areas
    }

    /// t₀ = 0 < t₁ < … < t_N, length².
    pub fn times(&self) -> &[f64] {
        self.transform.times()
    }

    /// t₁ … t_{N−1}, the times of the components, length².
    pub fn component_times(&self) -> &[f64] {
        self.transform.component_times()
    }

    /// S(t_k) = Σ_v M_v |φ_k(v)|, N − 1 values, length³.
    pub fn spectrum(&self) -> &[f64] {
        &self.spectrum
    }

    /// The transform of the function that was flowed.
    pub fn transform(&self) -> &SpectralTransform {
        &self.transform
    }

    /// The shape that is left once every component is removed, (3, V).
    pub fn residual(&self) -> Array2<f64> {
        self.shape(self.transform.residual())
    }

    /// The displacement that each band between neighbouring `edges` adds, (3, V) each: the sum
    /// of φ_k over edge_i ≤ t_k < edge_{i+1}. Each is summed up when it is asked for.
    ///
    /// # Errors
    /// If the edges do not increase.
    pub fn bands(&self, edges: &[f64]) -> Result<impl Iterator<Item = Array2<f64>>> {
        let bands = self.transform.bands(edges)?;
        Ok(bands.map(|band| self.displace(band)))
    }

    /// The shape filtered by H, given as N − 1 values H(t_k), (3, V).
    ///
    /// # Errors
    /// If `gains` are not N − 1 finite values.
    pub fn filter(&self, gains: &[f64]) -> Result<Array2<f64>> {
        Ok(self.shape(self.transform.filter(gains)?))
    }

    fn displace(&self, values: Array2<f64>) -> Array2<f64> {
        match &self.displacement {
            Some(displacement) => displacement.along_direction(values.view()),
            None => values,
        }
    }

    fn shape(&self, values: Array2<f64>) -> Array2<f64> {
        let shape = self.displace(values);
        match &self.displacement {
            Some(displacement) => shape + &displacement.base,
            None => shape,
        }
    }
}
