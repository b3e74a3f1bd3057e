//! The choice of elements: what a function on a mesh is made of while it flows.

use ndarray::{ArrayView1, ArrayView2};

use crate::named::named;

named! {
    /// The elements that a function on a mesh is made of while it flows.
    pub enum Elements: "elements" {
        /// Continuous, with one unknown per vertex (P1): the better ones for smooth functions. A set
        /// fades some per cent too fast in them.
        #[default]
        Vertices = "vertices",
        /// Crouzeix and Raviart's, with one unknown per edge: sets fade at their true rates. They have
        /// exact steps of total variation only.
        Edges = "edges",
    }
}

/// Vertices beyond which edges have to be asked for: their steps are factorized, which takes more time and
/// memory than several steps that are iterated on.
const MOST_VERTICES: usize = 250_000;

impl Elements {
    /// What suits a function with `values` (C, V): edges, where every channel has one or two values,
    /// so that it indicates a set, and not all of them one; else vertices, and beyond 250 000 of them.
    pub fn suiting(values: ArrayView2<f64>) -> Self {
        if values.ncols() > MOST_VERTICES {
            return Self::Vertices;
        }
        let counts: Vec<_> = values.rows().into_iter().map(count_up_to_three).collect();
        match counts.iter().max() {
            Some(2) => Self::Edges,
            _ => Self::Vertices,
        }
    }
}

/// How many values a channel has, 3 standing for more.
fn count_up_to_three(channel: ArrayView1<f64>) -> usize {
    let mut found: Vec<f64> = Vec::new();
    for &value in channel {
        if !found.contains(&value) {
            found.push(value);
        }
        if found.len() == 3 {
            break;
        }
    }
    found.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::array;

    #[test]
    fn edges_suit_what_indicates_sets() {
        let labels = array![
            [0.0, 1.0, 0.0, 1.0],
            [5.0, 5.0, -2.0, 5.0],
            [1.0, 1.0, 1.0, 1.0]
        ];
        assert_eq!(Elements::suiting(labels.view()), Elements::Edges);
        let smooth = array![[0.0, 1.0, 0.0, 1.0], [0.0, 0.1, 0.2, 0.3]];
        assert_eq!(Elements::suiting(smooth.view()), Elements::Vertices);
        let large =
            ndarray::Array2::from_shape_fn((1, MOST_VERTICES + 1), |(_, v)| v.min(1) as f64);
        assert_eq!(Elements::suiting(large.view()), Elements::Vertices);
        for constant in [array![[3.0, 3.0]], array![[f64::NAN, f64::NAN, f64::NAN]]] {
            assert_eq!(Elements::suiting(constant.view()), Elements::Vertices);
        }
    }
}
