//! Weights and masses at the end of a step, predicted from the last two states.
//!
//! The variables that are taken as linear in time, and the limits, were found by measuring the
//! error of bands on real meshes.

/// Least fraction of a gradient that a prediction leaves.
const LEAST_GRADIENT: f64 = 1e-3;
/// Change of ln m beyond which a mass is not predicted: a limb that collapses within a step
/// would be torn apart, its vertices losing their weight one here, one there.
const LARGEST_MASS_CHANGE: f64 = 2.0;

/// |∇u| on every face a step of `growth` times the last one's length ahead, √|∇u| taken as
/// linear in time: unlike the gradient itself, that neither changes sign nor bounces back where
/// a face goes flat.
pub(super) fn predicted_gradients(norms: &[f64], previous: &[f64], growth: f64) -> Vec<f64> {
    let least = LEAST_GRADIENT.sqrt();
    let predict = |(now, before): (&f64, &f64)| {
        let (now, before) = (now.sqrt(), before.sqrt());
        (now + growth * (now - before)).max(least * now).powi(2)
    };
    norms.iter().zip(previous).map(predict).collect()
}

/// Vertex masses a step ahead, ⁴√m taken as linear in time, as a mass goes like the square of
/// a gradient; the more it would change, the less of the change is believed.
pub(super) fn predicted_masses(masses: &[f64], previous: &[f64], growth: f64) -> Vec<f64> {
    let predict = |(&mass, before): (&f64, &f64)| {
        let ratio = (before / mass).sqrt().sqrt();
        let ahead = (1.0 + growth * (1.0 - ratio)).max(LEAST_GRADIENT);
        let change = 4.0 * ahead.ln();
        mass * (change * (-(change / LARGEST_MASS_CHANGE).powi(2)).exp()).exp()
    };
    masses.iter().zip(previous).map(predict).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_change_is_continued() {
        let ahead = predicted_gradients(&[0.99], &[1.0], 1.0)[0];
        assert!((ahead - 0.98).abs() < 1e-4);
        let ahead = predicted_masses(&[0.99], &[1.0], 1.0)[0];
        assert!((ahead - 0.98).abs() < 1e-4);
    }

    #[test]
    fn collapse_is_not_overshot() {
        let gradients = predicted_gradients(&[0.01, 0.0, 1.0], &[1.0, 0.5, 0.0], 2.0);
        assert!(gradients[0] > 0.0 && gradients[0] < 1e-4);
        assert_eq!(gradients[1], 0.0);
        assert!(gradients[2].is_finite());
        let masses = predicted_masses(&[1e-6, 1.0], &[1.0, 1e-6], 2.0);
        assert!((masses[0] / 1e-6 - 1.0).abs() < 1e-3);
        assert!(masses[1] > 1.0 && masses[1] < 3.0);
    }
}
