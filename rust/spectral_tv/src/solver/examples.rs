//! Small systems for the tests of the solvers.

use sprs::{CsMatI, TriMatI};

/// Numbers in [−1, 1) that are the same every time.
pub fn random<const L: usize>(size: usize, seed: u64) -> Vec<[f32; L]> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 40) as f32 / (1_u64 << 23) as f32 - 1.0
    };
    (0..size).map(|_| std::array::from_fn(|_| next())).collect()
}

/// Lower triangle and row sums of `mass` + the couplings between the ends of `edges`.
pub fn system_of(
    size: usize,
    edges: &[(usize, usize, f64)],
    masses: Vec<f64>,
) -> (CsMatI<f64, u32>, Vec<f64>) {
    let mut lower = TriMatI::new((size, size));
    for (vertex, mass) in masses.iter().enumerate() {
        lower.add_triplet(vertex, vertex, *mass);
    }
    for &(i, j, coupling) in edges {
        lower.add_triplet(i, i, coupling);
        lower.add_triplet(j, j, coupling);
        lower.add_triplet(i.max(j), i.min(j), -coupling);
    }
    (lower.to_csc(), masses)
}

/// A lattice with diagonals in its cells, its couplings jumping by 100 between halves.
pub fn lattice(columns: usize, rows: usize, mass: f64) -> (CsMatI<f64, u32>, Vec<f64>) {
    let mut edges = Vec::new();
    for i in 0..rows {
        for j in 0..columns {
            let here = i * columns + j;
            let coupling = if 2 * j < columns { 1.0 } else { 0.01 };
            if j + 1 < columns {
                edges.push((here, here + 1, coupling));
            }
            if i + 1 < rows {
                edges.push((here, here + columns, coupling));
            }
            if j + 1 < columns && i + 1 < rows {
                edges.push((here, here + columns + 1, 0.5 * coupling));
            }
        }
    }
    system_of(columns * rows, &edges, vec![mass; columns * rows])
}

/// A graph with a hub, a tail, components of one and two vertices, couplings and masses over
/// several orders of magnitude and a few couplings that are negative.
pub fn irregular(size: usize) -> (CsMatI<f64, u32>, Vec<f64>) {
    let noise = random::<2>(4 * size, 8);
    let mut edges = Vec::new();
    let last = size - 4;
    for (i, noise) in noise.iter().enumerate().take(last).skip(1) {
        let near = i - 1 - ((noise[0].abs() * 30.0) as usize).min(i - 1);
        let scale = 10.0_f64.powf(f64::from(noise[1]));
        edges.push((i, i - 1, scale));
        if near + 1 < i {
            // Far smaller than the path beside it: the matrix stays definite.
            let sign = if i % 9 == 0 { -1e-3 } else { 1.0 };
            edges.push((i, near, sign * scale.min(0.1)));
        }
        if i % 5 == 0 {
            edges.push((i, 0, 0.3));
        }
    }
    edges.push((size - 2, size - 1, 2.0));
    let masses = (0..size).map(|i| 0.05 * 10.0_f64.powf(f64::from(noise[size + i][0])));
    system_of(size, &edges, masses.collect())
}
