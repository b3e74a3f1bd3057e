//! Values at vertices from values at edges, limited so that none is beyond those around it.
//!
//! Zalesak 1979, "Fully multidimensional flux-corrected transport algorithms for fluids": what
//! sharpens a smooth function is scaled down, triangle by triangle, as far as it would overshoot.

/// The largest share of the corrections that each vertex has room for, upwards and downwards, V.
type Limits = Vec<[f64; 2]>;

/// Of one function: integrals over the vertices' areas, and what is known about their corrections.
///
/// A corner of a triangle of area A has the values a, b at its own edges, and c at the opposite one.
/// Its share of the integral is A/3 (a + b)/2. Its correction is δ = A/3 ((a + b)/2 − c). The three
/// corrections sum to 0, so any part α of them keeps the mean. With α = 1 the share is A/3 (a + b − c):
/// the linear function that is a, b, c at the midpoints, at its corner.
pub(super) struct Corrections {
    sums: Vec<f64>,
    /// Sums of the corrections upwards and downwards, sizes.
    wanted: Vec<[f64; 2]>,
    /// The largest and the least value around each vertex.
    bounds: Vec<[f64; 2]>,
}

impl Corrections {
    pub fn new(vertices: usize) -> Self {
        Self {
            sums: vec![0.0; vertices],
            wanted: vec![[0.0; 2]; vertices],
            bounds: vec![[f64::MIN, f64::MAX]; vertices],
        }
    }

    /// Takes in a triangle with the `values` at the edges opposite to its `corners`.
    pub fn take_in(&mut self, corners: [usize; 3], values: [f64; 3], third: f64) {
        let [a, b, c] = values;
        let (most, least) = (a.max(b).max(c), a.min(b).min(c));
        let corrections = corrections(values, third);
        for (k, corner) in corners.into_iter().enumerate() {
            self.sums[corner] += third * mean_beside(values, k);
            let correction = corrections[k];
            self.wanted[corner][usize::from(correction < 0.0)] += correction.abs();
            let bounds = &mut self.bounds[corner];
            *bounds = [bounds[0].max(most), bounds[1].min(least)];
        }
    }

    /// What there is room for, for vertices with these `areas`.
    pub fn limits(&self, areas: &[f64]) -> Limits {
        let around = self.sums.iter().zip(&self.bounds).zip(&self.wanted);
        let limits = around.zip(areas).map(|(((sum, bounds), wanted), area)| {
            [0, 1].map(|way| {
                let room = (area * bounds[way] - sum).abs();
                match wanted[way] > room {
                    true => room / wanted[way],
                    false => 1.0,
                }
            })
        });
        limits.collect()
    }

    /// Adds the corrections of a triangle, as far as its corners have room.
    pub fn correct(
        &mut self,
        corners: [usize; 3],
        values: [f64; 3],
        third: f64,
        limits: &[[f64; 2]],
    ) {
        let corrections = corrections(values, third);
        let mut share = 1.0_f64;
        for (corner, correction) in corners.into_iter().zip(corrections) {
            if correction != 0.0 {
                share = share.min(limits[corner][usize::from(correction < 0.0)]);
            }
        }
        for (corner, correction) in corners.into_iter().zip(corrections) {
            self.sums[corner] += share * correction;
        }
    }

    /// The integrals, V.
    pub fn into_sums(self) -> Vec<f64> {
        self.sums
    }
}

fn mean_beside(values: [f64; 3], k: usize) -> f64 {
    0.5 * (values[(k + 1) % 3] + values[(k + 2) % 3])
}

fn corrections(values: [f64; 3], third: f64) -> [f64; 3] {
    [0, 1, 2].map(|k| third * (mean_beside(values, k) - values[k]))
}
