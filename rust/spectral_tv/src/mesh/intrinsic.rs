//! Edge lengths and areas of triangles, and the intrinsic mollification of bad ones.

/// How far each triangle inequality must be from equality, relative to the mean edge length.
const MOLLIFICATION: f64 = 1e-6;

/// The one smallest amount by which all edges are to be enlarged so that every triangle
/// inequality is strict (Sharp and Crane 2020, "A Laplacian for Nonmanifold Triangle Meshes"). 0
/// for a healthy mesh. `lengths` are those of the edges of a triangle.
pub(super) fn enlargement(triangles: &[[u32; 3]], lengths: impl Fn(usize) -> [f64; 3]) -> f64 {
    let proper = (0..triangles.len()).filter(|&t| !repeats_an_index(&triangles[t]));
    let (mut count, mut sum, mut least) = (0_usize, 0.0, f64::INFINITY);
    for [a, b, c] in proper.map(lengths) {
        count += 1;
        sum += a + b + c;
        least = (b + c - a).min(c + a - b).min(a + b - c).min(least);
    }
    let mean = sum / (3 * count.max(1)) as f64;
    (MOLLIFICATION * mean - least).max(0.0)
}

/// Lengths of the edges of a triangle, `enlargement` added to each; all three 0 for a triangle
/// that repeats an index.
#[inline]
pub(super) fn enlarged(corners: [u32; 3], [a, b, c]: [f64; 3], enlargement: f64) -> [f64; 3] {
    match repeats_an_index(&corners) {
        true => [0.0; 3],
        false => [a + enlargement, b + enlargement, c + enlargement],
    }
}

/// Area from edge lengths, by Kahan's form of Heron's formula, which is stable for needles.
#[inline]
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

/// Lengths of the edges opposite to a triangle's corners, between points in space.
#[inline]
pub(super) fn embedded_lengths(vertices: &[[f64; 3]], [i, j, k]: [u32; 3]) -> [f64; 3] {
    let [p, q, r] = [
        &vertices[i as usize],
        &vertices[j as usize],
        &vertices[k as usize],
    ];
    [distance(q, r), distance(r, p), distance(p, q)]
}

#[inline]
fn distance(p: &[f64; 3], q: &[f64; 3]) -> f64 {
    let [x, y, z] = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    (x * x + y * y + z * z).sqrt()
}

#[inline]
pub(crate) fn repeats_an_index(&[a, b, c]: &[u32; 3]) -> bool {
    a == b || b == c || c == a
}
