//! Preconditioned conjugate gradients for operators that are only applied, never stored.

use ndarray::Array2;

/// Solves K x = `right_hand_side` (C, V) from x = 0 until the preconditioned residual has
/// fallen by `tolerance`, or for `most_iterations`. Where rounding leaves K no positive curvature
/// along a search, what was found before counts: the preconditioned residual at least.
///
/// `apply` gives K x; `precondition` replaces a residual by its approximate solution.
pub fn conjugate_gradients(
    apply: impl Fn(&Array2<f64>) -> Array2<f64>,
    mut precondition: impl FnMut(&mut Array2<f64>),
    right_hand_side: &Array2<f64>,
    tolerance: f64,
    most_iterations: usize,
) -> Array2<f64> {
    let mut solution = Array2::zeros(right_hand_side.dim());
    let mut residual = right_hand_side.clone();
    let mut preconditioned = residual.clone();
    precondition(&mut preconditioned);
    let mut search = preconditioned.clone();
    let mut energy = (&residual * &preconditioned).sum();
    let goal = tolerance * tolerance * energy;
    for iteration in 0..most_iterations {
        if energy <= goal {
            break;
        }
        let image = apply(&search);
        let length = energy / (&search * &image).sum();
        if !length.is_finite() || length <= 0.0 {
            return if iteration == 0 { search } else { solution };
        }
        solution.scaled_add(length, &search);
        residual.scaled_add(-length, &image);
        preconditioned.assign(&residual);
        precondition(&mut preconditioned);
        let next = (&residual * &preconditioned).sum();
        search *= next / energy;
        search += &preconditioned;
        energy = next;
    }
    solution
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::{arr1, arr2};

    #[test]
    fn a_singular_matrix_leaves_the_preconditioned_residual() {
        let right = arr2(&[[1.0, -2.0]]);
        let halve = |residual: &mut Array2<f64>| *residual *= 0.5;
        let nothing = |x: &Array2<f64>| x * 0.0;
        let solution = conjugate_gradients(nothing, halve, &right, 1e-3, 10);
        assert_eq!(solution, &right * 0.5);
    }

    #[test]
    fn solves_a_small_system_exactly() {
        let matrix = arr2(&[[4.0, 1.0, 0.0], [1.0, 3.0, -1.0], [0.0, -1.0, 2.0]]);
        let expected = arr2(&[[1.0, -2.0, 0.5]]);
        let right = expected.dot(&matrix);
        let inverse_diagonal = arr1(&[0.25, 1.0 / 3.0, 0.5]);
        let solution = conjugate_gradients(
            |x| x.dot(&matrix),
            |residual| *residual *= &inverse_diagonal,
            &right,
            1e-14,
            10,
        );
        assert!(
            (&solution - &expected)
                .iter()
                .all(|error| error.abs() < 1e-12)
        );
    }
}
