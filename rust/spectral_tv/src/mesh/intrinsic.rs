//! Edge lengths and areas of triangles, and the intrinsic mollification of bad ones.

/// How far each triangle inequality must be from equality, relative to the mean edge length.
const MOLLIFICATION: f64 = 1e-6;

/// Lengths of the edges opposite to each triangle's corners, all enlarged by the one smallest
/// amount that makes every triangle inequality strict (Sharp and Crane 2020, "A Laplacian for
/// Nonmanifold Triangle Meshes"). A healthy mesh is left as it is.
pub(super) fn mollified_edge_lengths(
    vertices: &[[f64; 3]],
    triangles: &[[u32; 3]],
) -> Vec<[f64; 3]> {
    let mut lengths: Vec<[f64; 3]> = triangles
        .iter()
        .map(|&corners| embedded_lengths(vertices, corners))
        .collect();
    let proper = || triangles.iter().map(|t| !repeats_an_index(t));
    let proper_count = proper().filter(|&is_proper| is_proper).count();
    let mean = lengths.iter().flatten().sum::<f64>() / (3 * proper_count.max(1)) as f64;

    let enlargement = lengths
        .iter()
        .zip(proper())
        .filter(|(_, is_proper)| *is_proper)
        .map(|(&[a, b, c], _)| MOLLIFICATION * mean - (b + c - a).min(c + a - b).min(a + b - c))
        .fold(0.0, f64::max);
    for (lengths, is_proper) in lengths.iter_mut().zip(proper()) {
        *lengths = match is_proper {
            true => lengths.map(|length| length + enlargement),
            false => [0.0; 3],
        };
    }
    lengths
}

/// Area from edge lengths, by Kahan's form of Heron's formula, which is stable for needles.
pub(crate) fn face_area(lengths: [f64; 3]) -> f64 {
    let [mut a, mut b, mut c] = lengths;
    if a < b {
        (a, b) = (b, a);
    }
    if b < c {
        (b, c) = (c, b);
    }
    if a < b {
        (a, b) = (b, a);
    }
    let product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
    0.25 * product.max(0.0).sqrt()
}

fn embedded_lengths(vertices: &[[f64; 3]], corners: [u32; 3]) -> [f64; 3] {
    let [p, q, r] = corners.map(|corner| vertices[corner as usize]);
    [distance(q, r), distance(r, p), distance(p, q)]
}

fn distance(p: [f64; 3], q: [f64; 3]) -> f64 {
    (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>().sqrt()
}

fn repeats_an_index(&[a, b, c]: &[u32; 3]) -> bool {
    a == b || b == c || c == a
}
