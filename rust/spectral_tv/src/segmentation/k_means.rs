//! Weighted k-means: Lloyd's iteration from k-means++ (Arthur and Vassilvitskii 2007).

use ndarray::{Array2, ArrayView1, ArrayView2};

use crate::error::Result;
use crate::monitor::Stage;

/// Runs from different starts, of which the best is kept.
const STARTS: usize = 8;
/// Points of which the starts are found; the best goes on with all.
const SAMPLE: usize = 10_000;
const MOST_ITERATIONS: usize = 100;

/// The label, 0 to k − 1, of the centre nearest to each of `points` (N, D) that have the `weights`
/// N, for k centres of least weighted square distance. Labels are in the order of falling weight.
pub(super) fn k_means(
    points: ArrayView2<f64>,
    weights: &[f64],
    k: usize,
    seed: u64,
    stage: Stage,
) -> Result<Vec<usize>> {
    let mut random = fastrand::Rng::with_seed(seed);
    let sample: Vec<usize> = match points.nrows() {
        all if all <= SAMPLE => (0..all).collect(),
        all => random.choose_multiple(0..all, SAMPLE),
    };
    let sampled = points.select(ndarray::Axis(0), &sample);
    let sampled_weights: Vec<f64> = sample.iter().map(|&index| weights[index]).collect();
    let mut best: Option<Clustering> = None;
    for start in 0..STARTS {
        stage.report(0.5 * start as f64 / STARTS as f64)?;
        let centres = spread_centres(sampled.view(), &sampled_weights, k, &mut random);
        let found = lloyd(sampled.view(), &sampled_weights, centres, stage)?;
        if best.as_ref().is_none_or(|best| found.cost < best.cost) {
            best = Some(found);
        }
    }
    stage.report(0.5)?;
    let centres = best.expect("there is a start").centres;
    let labels = lloyd(points, weights, centres, stage)?.labels;
    Ok(by_weight(labels, weights, k))
}

struct Clustering {
    centres: Array2<f64>,
    labels: Vec<usize>,
    cost: f64,
}

/// Centres drawn from the points with a probability that grows as their square distance to the
/// centres drawn before.
fn spread_centres(
    points: ArrayView2<f64>,
    weights: &[f64],
    k: usize,
    random: &mut fastrand::Rng,
) -> Array2<f64> {
    let mut centres = Array2::zeros((k, points.ncols()));
    let mut distances = vec![1.0; points.nrows()];
    for index in 0..k {
        let total: f64 = distances.iter().zip(weights).map(|(d, w)| d * w).sum();
        let mut left = random.f64() * total;
        let mut chosen = 0;
        for (point, (distance, weight)) in distances.iter().zip(weights).enumerate() {
            left -= distance * weight;
            if *distance > 0.0 {
                chosen = point;
            }
            if left <= 0.0 {
                break;
            }
        }
        centres.row_mut(index).assign(&points.row(chosen));
        for (distance, point) in distances.iter_mut().zip(points.rows()) {
            let new = square_distance(point, points.row(chosen));
            *distance = if index == 0 { new } else { new.min(*distance) };
        }
    }
    centres
}

/// Labels, then means, until no label changes.
fn lloyd(
    points: ArrayView2<f64>,
    weights: &[f64],
    mut centres: Array2<f64>,
    stage: Stage,
) -> Result<Clustering> {
    let mut labels = vec![usize::MAX; points.nrows()];
    let mut cost = f64::INFINITY;
    for _ in 0..MOST_ITERATIONS {
        stage.check()?;
        let mut has_changed = false;
        cost = 0.0;
        for ((label, point), weight) in labels.iter_mut().zip(points.rows()).zip(weights) {
            let (nearest, distance) = nearest(point, &centres);
            has_changed |= *label != nearest;
            *label = nearest;
            cost += weight * distance;
        }
        if !has_changed {
            break;
        }
        centres = means(points, weights, &labels, centres);
    }
    Ok(Clustering {
        centres,
        labels,
        cost,
    })
}

/// The weighted mean of every cluster; an empty one keeps its centre.
fn means(
    points: ArrayView2<f64>,
    weights: &[f64],
    labels: &[usize],
    mut centres: Array2<f64>,
) -> Array2<f64> {
    let mut sums = Array2::<f64>::zeros(centres.dim());
    let mut totals = vec![0.0; centres.nrows()];
    for ((&label, point), &weight) in labels.iter().zip(points.rows()).zip(weights) {
        sums.row_mut(label).scaled_add(weight, &point);
        totals[label] += weight;
    }
    for ((mut centre, sum), total) in centres.rows_mut().into_iter().zip(sums.rows()).zip(totals) {
        if total > 0.0 {
            centre.assign(&(&sum / total));
        }
    }
    centres
}

fn nearest(point: ArrayView1<f64>, centres: &Array2<f64>) -> (usize, f64) {
    let mut best = (0, f64::INFINITY);
    for (index, centre) in centres.rows().into_iter().enumerate() {
        let distance = square_distance(point, centre);
        if distance < best.1 {
            best = (index, distance);
        }
    }
    best
}

fn square_distance(a: ArrayView1<f64>, b: ArrayView1<f64>) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// Renumbers labels by the weight of their clusters, the heaviest first.
fn by_weight(mut labels: Vec<usize>, weights: &[f64], k: usize) -> Vec<usize> {
    let mut totals = vec![0.0; k];
    for (&label, weight) in labels.iter().zip(weights) {
        totals[label] += weight;
    }
    let mut order: Vec<usize> = (0..k).collect();
    order.sort_by(|&a, &b| totals[b].total_cmp(&totals[a]));
    let mut rank = vec![0; k];
    for (position, &label) in order.iter().enumerate() {
        rank[label] = position;
    }
    labels.iter_mut().for_each(|label| *label = rank[*label]);
    labels
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::monitor::Monitor;

    #[test]
    fn separate_clusters_are_found_and_numbered_by_weight() {
        let centres = [[0.0, 0.0], [5.0, 0.0], [0.0, 7.0]];
        let mut random = fastrand::Rng::with_seed(3);
        let which: Vec<usize> = (0..300).map(|i| [0, 1, 1, 2, 2, 2][i % 6]).collect();
        let points =
            Array2::from_shape_fn((300, 2), |(i, axis)| centres[which[i]][axis] + random.f64());
        let monitor = Monitor::new();
        for seed in 0..5 {
            let labels = k_means(points.view(), &[1.0; 300], 3, seed, monitor.whole()).unwrap();
            for (label, which) in labels.iter().zip(&which) {
                assert_eq!(*label, 2 - which);
            }
        }
    }

    #[test]
    fn fewer_different_points_than_clusters_leave_some_empty() {
        let points = Array2::from_shape_fn((6, 1), |(i, _)| (i % 2) as f64);
        let monitor = Monitor::new();
        let labels = k_means(points.view(), &[1.0; 6], 4, 0, monitor.whole()).unwrap();
        assert_eq!(labels[0], labels[2]);
        assert_ne!(labels[0], labels[1]);
    }
}
