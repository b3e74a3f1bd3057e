//! κ: how much the mass of edge elements has to be enlarged so that sets have their true area.
//!
//! Where a border crosses a triangle, edges are neither in the set nor outside. Sampled at vertices
//! the set has 1/2 there; its exact means along the edges are v_e. The pairing Σ M_e (S f)_e v_e is
//! then less than the area of the set, and sets would fade too fast. Let the triangle's corners be
//! at 0, x and 1 across the border, in units of its width L there, and let the border lie anywhere
//! with equal probability. The mean loss is A/6 whatever x is. The term of H in κ adds
//! κ A (1 − x + x²)/24, so κ = 4/(1 − x + x²) restores the area for one direction. All directions
//! together, each as often as it meets the triangle, that is with the weight L, give
//!
//! κ = 4 ∫ L dφ / ∫ L (1 − x + x²) dφ,  L (1 − x + x²) = (p² + q² + r²)/(2 L),
//!
//! where p, q, r are the widths of the edges in the direction φ, and L is the largest of them. It is 4
//! for needles, 4.85 for equilateral triangles and up to
//! 16/3 for flat ones with their corner in the middle.

use std::f64::consts::FRAC_PI_2;

/// Nodes and weights of Gauss and Legendre on [−1, 1].
const NODES: [(f64, f64); 5] = [
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

/// κ of a triangle with edges of these lengths; 4 where they span no area.
pub(super) fn over_lumping(lengths: [f64; 3]) -> f64 {
    let turned = |k: usize| [lengths[k], lengths[(k + 1) % 3], lengths[(k + 2) % 3]];
    let angles = [0, 1, 2].map(|k| {
        let [a, b, c] = turned(k);
        (0.5 * (b / c + c / b - (a / b) * (a / c)))
            .clamp(-1.0, 1.0)
            .acos()
    });
    // With an edge a along φ = 0 it is the widest between the normals of its neighbours.
    let where_widest = |k: usize| {
        let [a, b, c] = turned(k);
        let [at_a, at_b, at_c] = [0, 1, 2].map(|other| angles[(k + other) % 3]);
        let integrand = |node: f64| {
            let phi = at_b - FRAC_PI_2 + 0.5 * at_a * (1.0 + node);
            let [p, q, r] = [
                a * phi.cos(),
                b * (phi + at_c).cos(),
                c * (phi - at_b).cos(),
            ];
            0.5 * (p + q * (q / p) + r * (r / p))
        };
        let terms = NODES.map(|(node, weight)| weight * integrand(node));
        0.5 * at_a * terms.iter().sum::<f64>()
    };
    let spread: f64 = [0, 1, 2].map(where_widest).iter().sum();
    let kappa = 4.0 * lengths.iter().sum::<f64>() / spread;
    match kappa.is_finite() {
        true => kappa.clamp(4.0, 16.0 / 3.0),
        false => 4.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kappa_depends_on_the_shape_alone() {
        // ∫ 3/(4 cos φ) over a third of the directions.
        let equilateral = 4.0 * 3.0 / (3.0 * 1.5 * (FRAC_PI_2 / 6.0 + FRAC_PI_2 / 2.0).tan().ln());
        for size in [1e-60, 1.0, 1e40] {
            assert!((over_lumping([size; 3]) - equilateral).abs() < 1e-4);
        }
        let turned = [[3.0, 4.0, 5.0], [5.0, 3.0, 4.0], [4.0, 5.0, 3.0]].map(over_lumping);
        assert!(turned.iter().all(|kappa| (kappa - turned[0]).abs() < 1e-12));
    }

    #[test]
    fn needles_have_the_least_and_flat_triangles_the_most() {
        assert!((over_lumping([1e-3, 1.0, 1.0]) - 4.0).abs() < 0.01);
        assert!((over_lumping([1.0, 0.5001, 0.5001]) - 16.0 / 3.0).abs() < 0.05);
        assert_eq!(over_lumping([0.0; 3]), 4.0);
        assert_eq!(over_lumping([0.0, 1.0, 1.0]), 4.0);
    }
}
