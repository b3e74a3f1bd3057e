//! Where thin parts keep what thick ones lose: the spectrum cut by the thickness of the shape.

use ndarray::Array2;
use rayon::prelude::*;

use crate::error::{ArgumentError, Result, has_usable_size};
use crate::flow::Trajectory;
use crate::mesh::TriangleMesh;
use crate::monitor::Stage;
use crate::parallel;
use crate::thickness::thickness_with;

/// How far the cut of a component is blurred, in ln t.
const BLUR: f64 = 0.7;

/// A cut of every vertex's spectrum by the thickness r of the shape there.
///
/// A limb of the radius r vanishes at t ≈ r². What is left of it before that is a string. So the time
/// axis of a vertex ends near r²/k: an edge e between bands lies at s(e) = e / √(1 + (k e / r²)²). What
/// is later goes to the residual. The components φ_k belong to bands by the share
/// x_k(s) = smoothstep((ln s − ln a_k) / (ln b_k − ln a_k)) that is before s, with
/// a_k = √(t_{k−1} t_k) e^−0.7 and b_k = √(t_k t_{k+1}) e^0.7. It is a filter H(t, v), so the flow stays as
/// it is, and bands and residual add up to the function.
#[derive(Debug, Clone)]
pub(crate) struct ThicknessCut {
    /// ln r²/k of every vertex, V.
    latest: Vec<f64>,
}

impl ThicknessCut {
    /// The cut by k = `keep_limbs` and the thickness of `mesh`; `None` where k is 0, as nothing is cut.
    ///
    /// # Errors
    /// If k is negative or not finite; or as [`thickness_with`].
    pub fn new(mesh: &TriangleMesh, keep_limbs: f64, stage: Stage) -> Result<Option<Self>> {
        if !(keep_limbs >= 0.0 && has_usable_size(keep_limbs)) {
            let found = format_args!("{keep_limbs:?}");
            let rule = "must be 0 or more and at most 1e100";
            return Err(ArgumentError::value("keep_limbs", rule, found).into());
        }
        if keep_limbs == 0.0 {
            return Ok(None);
        }
        let latest = |r: &f64| (r * r / keep_limbs).ln();
        Ok(Some(Self {
            latest: parallel::map(thickness_with(mesh, stage)?, latest),
        }))
    }

    /// The bands between neighbouring `edges`, (C, V) each.
    pub fn bands<'a>(
        self,
        trajectory: &'a Trajectory,
        edges: &'a [f64],
    ) -> impl Iterator<Item = Array2<f64>> + 'a {
        let mut before = self.before(trajectory, edges[0]);
        edges[1..].iter().map(move |&edge| {
            let now = self.before(trajectory, edge);
            let band = &now - &before;
            before = now;
            band
        })
    }

    /// What lies before an edge at every vertex, (C, V), in the units of `trajectory`.
    pub fn before(&self, trajectory: &Trajectory, edge: f64) -> Array2<f64> {
        let shares = Shares::of(&trajectory.times);
        let logarithm = edge.ln();
        let mut sum = parallel::zeros(trajectory.initial().dim());
        parallel::columns_mut(&mut sum.view_mut()).for_each(|(first, mut columns)| {
            let latest = &self.latest[first..first + columns.ncols()];
            let cuts: Vec<f64> = latest.iter().map(|&l| soft_least(logarithm, l)).collect();
            let last = cuts.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let (mut weights, mut factors) = (vec![0.0; cuts.len()], vec![0.0; cuts.len()]);
            for (step, increment) in trajectory.increments().iter().enumerate() {
                if !shares.reach(step, last) {
                    break;
                }
                let duration = shares.times[step + 1] - shares.times[step];
                for ((factor, weight), &cut) in factors.iter_mut().zip(&mut weights).zip(&cuts) {
                    let next = shares.weight(step + 1, cut);
                    *factor = (std::mem::replace(weight, next) - next) / duration;
                }
                increment.add_weighted(&factors, first, &mut columns);
            }
        });
        sum
    }
}

/// ln of 1/√(e⁻² + l⁻²) for the logarithms of e and l.
fn soft_least(one: f64, other: f64) -> f64 {
    let least = one.min(other);
    match least.is_finite() {
        true => least - 0.5 * (-2.0 * (one - other).abs()).exp().ln_1p(),
        false => least,
    }
}

/// Which share of each component is before a time.
struct Shares {
    times: Vec<f64>,
    /// ln a_k and ln b_k of the components k = 1 … N − 1.
    blurs: Vec<[f64; 2]>,
}

impl Shares {
    fn of(times: &[f64]) -> Self {
        let mean = |t: f64, u: f64| 0.5 * (t.ln() + u.ln());
        let blur = |k: usize| {
            let before = match k {
                // As if times went on in the same ratio.
                1 => times[1] * (times[1] / times[2]),
                k => times[k - 1],
            };
            [
                mean(before, times[k]) - BLUR,
                mean(times[k], times[k + 1]) + BLUR,
            ]
        };
        Self {
            times: times.to_vec(),
            blurs: (1..times.len() - 1).map(blur).collect(),
        }
    }

    /// x_k of the component t_k at a time's logarithm; 0 for the ends of the axis, which are no
    /// components.
    fn share(&self, k: usize, cut: f64) -> f64 {
        let Some([from, to]) = k.checked_sub(1).and_then(|k| self.blurs.get(k)) else {
            return 0.0;
        };
        let x = ((cut - from) / (to - from)).clamp(0.0, 1.0);
        x * x * (3.0 - 2.0 * x)
    }

    /// Whether anything of a step's increment is before a time.
    fn reach(&self, step: usize, cut: f64) -> bool {
        self.share(step.max(1), cut) > 0.0
    }

    /// x_k t_k. The increment of the step from t_k counts by the difference of two of them, by its
    /// duration, see [`crate::spectral::SpectralTransform::combination`].
    fn weight(&self, k: usize, cut: f64) -> f64 {
        self.share(k, cut) * self.times[k]
    }
}
