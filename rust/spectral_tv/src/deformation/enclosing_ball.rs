//! The smallest ball around points.

use nalgebra::{DMatrix, DVector, Vector3};

/// Relative rounding of a distance.
const ROUNDING: f64 = 1e-12;
/// The radius grows with every pivot, so there is an end; a handful of pivots is what it takes.
const MOST_PIVOTS: usize = 1000;

/// Centre and radius of the smallest ball that holds all `points`; the origin and 0 if there are
/// none. It does not depend on how they lie in space, nor on how often a point is repeated.
pub(super) fn enclosing_ball(points: &[Vector3<f64>]) -> (Vector3<f64>, f64) {
    let Some(&first) = points.first() else {
        return (Vector3::zeros(), 0.0);
    };
    let mut support = vec![first];
    let (mut centre, mut radius) = (first, 0.0);
    for _ in 0..MOST_PIVOTS {
        let (distance, outermost) = farthest(points, centre);
        if distance <= radius * (1.0 + ROUNDING) {
            break;
        }
        support.push(outermost);
        let Some(larger) = smallest_of_few(&support).filter(|ball| ball.1 > radius) else {
            break;
        };
        (centre, radius, support) = larger;
    }
    (centre, farthest(points, centre).0)
}

fn farthest(points: &[Vector3<f64>], centre: Vector3<f64>) -> (f64, Vector3<f64>) {
    let outermost = points.iter().map(|point| (point - centre).norm_squared());
    let (square, index) =
        outermost.zip(0..).fold(
            (0.0, 0),
            |most, next| if next.0 > most.0 { next } else { most },
        );
    (square.sqrt(), points[index])
}

/// The smallest ball around up to five points, and the points on its boundary that define it.
fn smallest_of_few(points: &[Vector3<f64>]) -> Option<(Vector3<f64>, f64, Vec<Vector3<f64>>)> {
    let subsets = (1_u32..1 << points.len()).filter(|subset| subset.count_ones() <= 4);
    let balls = subsets.filter_map(|subset| {
        let chosen = (0..points.len()).filter(|i| subset >> i & 1 == 1);
        let chosen: Vec<_> = chosen.map(|i| points[i]).collect();
        let (centre, radius) = circumscribed_ball(&chosen)?;
        let holds = |point: &Vector3<f64>| (point - centre).norm() <= radius * (1.0 + ROUNDING);
        points.iter().all(holds).then_some((centre, radius, chosen))
    });
    balls.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The ball centred in the span of the `points` that has all of them on its boundary.
fn circumscribed_ball(points: &[Vector3<f64>]) -> Option<(Vector3<f64>, f64)> {
    let edges: Vec<_> = points[1..].iter().map(|point| point - points[0]).collect();
    if edges.is_empty() {
        return Some((points[0], 0.0));
    }
    let size = edges.len();
    let products = DMatrix::from_fn(size, size, |i, j| edges[i].dot(&edges[j]));
    let halves = DVector::from_fn(size, |i, _| 0.5 * edges[i].norm_squared());
    let shares = products.lu().solve(&halves)?;
    let offset: Vector3<f64> = edges.iter().zip(shares.iter()).map(|(e, s)| e * *s).sum();
    Some((points[0] + offset, offset.norm()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points in no order, on the unit sphere or within it, that do not all lie on one side.
    fn scattered(count: usize, shrink: impl Fn(usize) -> f64) -> Vec<Vector3<f64>> {
        let point = |i: usize| {
            let (z, angle) = (1.0 - 2.0 * (i as f64 + 0.5) / count as f64, 2.4 * i as f64);
            let around = (1.0 - z * z).sqrt();
            Vector3::new(around * angle.cos(), around * angle.sin(), z) * shrink(i)
        };
        (0..count).map(point).collect()
    }

    #[test]
    fn two_points_span_it_however_often_they_are_repeated() {
        let (a, b) = (Vector3::new(1.0, 2.0, 3.0), Vector3::new(1.5, 1.0, -1.0));
        let (centre, radius) = enclosing_ball(&[a, a, a, b, a, b, b]);
        assert!((centre - (a + b) / 2.0).norm() < 1e-14);
        assert!((radius - (a - b).norm() / 2.0).abs() < 1e-14);
        assert_eq!(enclosing_ball(&[a, a]), (a, 0.0));
    }

    #[test]
    fn points_of_a_sphere_have_that_sphere_whatever_lies_within() {
        let shift = Vector3::new(-4.0, 0.5, 7.0);
        for shrink in [1.0, 0.7] {
            let points = scattered(500, |i| if i % 5 == 0 { 1.0 } else { shrink });
            let points: Vec<_> = points.iter().map(|p| 3.0 * p + shift).collect();
            let (centre, radius) = enclosing_ball(&points);
            assert!((centre - shift).norm() < 1e-6);
            assert!((radius - 3.0).abs() < 1e-9);
        }
    }

    #[test]
    fn an_obtuse_triangle_has_its_longest_edge_for_a_diameter() {
        let points = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 0.5, 0.0]].map(Vector3::from);
        let (centre, radius) = enclosing_ball(&points);
        assert!((centre - Vector3::new(2.0, 0.0, 0.0)).norm() < 1e-14);
        assert!((radius - 2.0).abs() < 1e-14);
    }
}
