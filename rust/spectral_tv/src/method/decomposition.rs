//! A shape split into scales.

use ndarray::Array2;

use crate::error::{ArgumentError, Result, unusable_values};
use crate::mesh::TriangleMesh;
use crate::method::Displacement;
use crate::monitor::{Monitor, Stage};
use crate::spectral::{SpectralTransform, ThicknessCut};

/// The spectral components of a shape, as displacements of its vertices.
#[derive(Debug, Clone)]
pub struct Decomposition {
    transform: SpectralTransform,
    /// How what M3 flows becomes a shape; `None` where the positions themselves were flowed.
    displacement: Option<Displacement>,
    spectrum: Vec<f64>,
    vertex_areas: Vec<f64>,
    /// What was decomposed.
    mesh: TriangleMesh,
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
        mesh: &TriangleMesh,
        stage: Stage,
    ) -> Result<Self> {
        Ok(Self {
            mesh: mesh.clone(),
            spectrum: transform.spectrum_with(vertex_areas, stage)?,
            transform,
            displacement,
            vertex_areas: vertex_areas.to_vec(),
        })
    }

    /// A decomposition from the parts of another: its transform, M3's base and direction, the
    /// spectrum, N − 1, the areas of the vertices, V, and the mesh that was decomposed.
    ///
    /// # Errors
    /// If shapes do not go together, or a number is not finite.
    pub fn restored(
        transform: SpectralTransform,
        displacement: Option<Displacement>,
        spectrum: Vec<f64>,
        vertex_areas: Vec<f64>,
        mesh: TriangleMesh,
    ) -> Result<Self> {
        let trajectory = transform.trajectory();
        let (channels, vertices) = trajectory.initial().dim();
        let has_shapes = match &displacement {
            None => channels == 3,
            Some(Displacement { base, direction }) => {
                let is_scalar = direction.is_some();
                channels == if is_scalar { 1 } else { 3 }
                    && base.dim() == (3, vertices)
                    && direction.iter().all(|found| found.dim() == (3, vertices))
            }
        };
        let has_counts = spectrum.len() == transform.component_times().len()
            && vertex_areas.len() == vertices
            && mesh.vertex_count() == vertices;
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
            let mut parts = std::iter::once(&found.base).chain(&found.direction);
            parts.all(|part| unusable_values(part.view()).is_none())
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
            mesh,
        })
    }

    /// The mesh that was decomposed.
    pub fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// How what M3 flows becomes a shape; `None` where the positions themselves were flowed.
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

    /// The displacement that each band between neighbouring `edges` adds, (3, V) each: see
    /// [`SpectralTransform::bands`]. Each is summed up when it is asked for.
    ///
    /// # Errors
    /// If the edges do not increase.
    pub fn bands(&self, edges: &[f64]) -> Result<impl Iterator<Item = Array2<f64>>> {
        let bands = self.transform.bands(edges)?;
        Ok(bands.map(|band| self.displace(band)))
    }

    /// The same with limbs kept: the spectrum of every vertex ends near r²/k for k = `keep_limbs` and the
    /// thickness r of the shape there, and what is later stays in the residual. That is the shape
    /// without the bands. 1 suits characters; more keeps more, less lets bands take more; 0 is
    /// [`Self::bands`].
    ///
    /// # Errors
    /// If the edges do not increase or k is negative; or as [`crate::thickness::thickness`].
    pub fn bands_keeping_limbs<'a>(
        &'a self,
        edges: &'a [f64],
        keep_limbs: f64,
    ) -> Result<impl Iterator<Item = Array2<f64>> + use<'a>> {
        self.bands_keeping_limbs_with(edges, keep_limbs, Monitor::new().whole())
    }

    /// [`Self::bands_keeping_limbs`], watched while the thickness is measured.
    ///
    /// # Errors
    /// As [`Self::bands_keeping_limbs`], or [`crate::Error::Cancelled`].
    pub fn bands_keeping_limbs_with<'a>(
        &'a self,
        edges: &'a [f64],
        keep_limbs: f64,
        stage: Stage,
    ) -> Result<impl Iterator<Item = Array2<f64>> + use<'a>> {
        let bands: Box<dyn Iterator<Item = _>> =
            match ThicknessCut::new(&self.mesh, keep_limbs, stage)? {
                None => Box::new(self.transform.bands(edges)?),
                Some(cut) => Box::new(self.transform.bands_cut(edges, cut)?),
            };
        Ok(bands.map(|band| self.displace(band)))
    }

    /// The shape filtered by H, given as N − 1 values H(t_k), (3, V).
    ///
    /// # Errors
    /// If `gains` are not N − 1 finite values.
    pub fn filter(&self, gains: &[f64]) -> Result<Array2<f64>> {
        Ok(self.shape(self.transform.filter(gains)?))
    }

    /// The same with limbs kept, as [`Self::bands_keeping_limbs`] does.
    ///
    /// # Errors
    /// If `gains` are not N − 1 finite values or k is negative; or as [`crate::thickness::thickness`].
    pub fn filter_keeping_limbs(&self, gains: &[f64], keep_limbs: f64) -> Result<Array2<f64>> {
        self.filter_keeping_limbs_with(gains, keep_limbs, Monitor::new().whole())
    }

    /// [`Self::filter_keeping_limbs`], watched while the thickness is measured.
    ///
    /// # Errors
    /// As [`Self::filter_keeping_limbs`], or [`crate::Error::Cancelled`].
    pub fn filter_keeping_limbs_with(
        &self,
        gains: &[f64],
        keep_limbs: f64,
        stage: Stage,
    ) -> Result<Array2<f64>> {
        let filtered = match ThicknessCut::new(&self.mesh, keep_limbs, stage)? {
            None => self.transform.filter(gains)?,
            Some(cut) => self.transform.filter_cut(gains, &cut)?,
        };
        Ok(self.shape(filtered))
    }

    fn displace(&self, values: Array2<f64>) -> Array2<f64> {
        match &self.displacement {
            Some(displacement) => displacement.of(values),
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
