//! Tangent vector fields with several channels: gradients, and their duals.

use crate::operators::FaceVector;

/// One tangent vector per channel and face, C × F.
pub type TangentField = Vec<Vec<FaceVector>>;

/// `factor` times a vector.
#[inline]
pub fn scaled(factor: f64, [x, y]: FaceVector) -> FaceVector {
    [factor * x, factor * y]
}

/// ⟨a, b⟩ on every face, over all channels.
pub fn inner_products(a: &TangentField, b: &TangentField) -> Vec<f64> {
    let mut products = vec![0.0; a[0].len()];
    for (a, b) in a.iter().zip(b) {
        for ((product, p), q) in products.iter_mut().zip(a).zip(b) {
            *product += p[0] * q[0] + p[1] * q[1];
        }
    }
    products
}

/// min(1, 1/|z|) on every face, |z| over all channels together.
pub fn clipping_factors(field: &TangentField) -> Vec<f64> {
    let mut factors = vec![0.0; field.first().map_or(0, Vec::len)];
    for channel in field {
        for (square, [x, y]) in factors.iter_mut().zip(channel) {
            *square += x * x + y * y;
        }
    }
    for factor in &mut factors {
        *factor = if *factor > 1.0 {
            factor.sqrt().recip()
        } else {
            1.0
        };
    }
    factors
}
