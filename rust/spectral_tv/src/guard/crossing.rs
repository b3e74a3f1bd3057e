//! Whether two triangles cross, by exact predicates.
//!
//! After Guigue and Devillers 2003, "Fast and Robust Triangle-Triangle Overlap Test Using Orientation
//! Predicates". All decisions are signs of determinants, which are exact (Shewchuk 1997). So no
//! tolerance is needed, and triangles that share corners are no special case.

use robust::{Coord, Coord3D, orient2d, orient3d};

pub(super) type Triangle = [[f64; 3]; 3];

/// Whether a point inside one of the triangles is in the other: inside it or on its border. Those
/// that merely touch at their borders, as neighbours do, do not cross. A triangle without area has
/// no inside, and crosses nothing.
pub(super) fn cross(one: &Triangle, other: &Triangle) -> bool {
    let of_one = sides(one, other);
    if is_apart(of_one) {
        return false;
    }
    let of_other = sides(other, one);
    if is_apart(of_other) {
        return false;
    }
    if of_one == [0; 3] || of_other == [0; 3] {
        return overlap(one, other);
    }
    // Both planes meet in a line. A triangle with corners on both sides of the other's plane has a
    // part of the line inside.
    if !(is_parted(of_one) || is_parted(of_other)) {
        return false;
    }
    let (first, first_side) = turned(one, of_one);
    let (second, second_side) = turned(other, of_other);
    let [p, q, r] = oriented(first, second_side);
    let [s, t, u] = oriented(second, first_side);
    // The parts of the line within both triangles, whose ends are on the edges at p and at s.
    side(&[p, q, s], t) < 0 && side(&[p, r, u], s) < 0
}

/// On which side of the plane of `other` each corner is: 1 above it, from where its corners go
/// round against the clock, 0 on it, -1 below.
fn sides(corners: &Triangle, other: &Triangle) -> [i8; 3] {
    corners.map(|corner| side(other, corner))
}

fn side(plane: &Triangle, point: [f64; 3]) -> i8 {
    // As with neighbours; the predicate takes long to find it out.
    if plane.contains(&point) {
        return 0;
    }
    let [a, b, c, d] = [plane[0], plane[1], plane[2], point].map(|[x, y, z]| Coord3D { x, y, z });
    // It is positive below.
    sign(-orient3d(a, b, c, d))
}

fn sign(value: f64) -> i8 {
    i8::from(value > 0.0) - i8::from(value < 0.0)
}

/// Whether all are strictly on one side.
fn is_apart(sides: [i8; 3]) -> bool {
    sides == [1; 3] || sides == [-1; 3]
}

/// Whether some are on either side.
fn is_parted(sides: [i8; 3]) -> bool {
    sides.contains(&1) && sides.contains(&-1)
}

/// The triangle turned so that its first corner is alone: on a side of the other's plane where no
/// other corner is, or on the plane with both others on one side. And on which side the first is.
fn turned(corners: &Triangle, sides: [i8; 3]) -> (Triangle, i8) {
    let is_alone = |which: i8| sides.iter().filter(|&&side| side == which).count() == 1;
    let alone = [1, -1, 0].into_iter().find(|&which| is_alone(which));
    let alone = alone.expect("three signs that are not all the same, or two of them 0");
    let place = sides
        .iter()
        .position(|&side| side == alone)
        .expect("it is there");
    let side = match alone {
        0 => -sides[(place + 1) % 3],
        side => side,
    };
    (std::array::from_fn(|k| corners[(place + k) % 3]), side)
}

/// Turned round, if `side` is below, so that what is alone is above.
fn oriented([a, b, c]: Triangle, side: i8) -> Triangle {
    match side {
        -1 => [a, c, b],
        _ => [a, b, c],
    }
}

/// Whether triangles in one plane have a part in common that has area.
fn overlap(one: &Triangle, other: &Triangle) -> bool {
    // Along an axis from which neither is seen as a line.
    let axis = (0..3).find(|&axis| turn(&seen(one, axis)) != 0 && turn(&seen(other, axis)) != 0);
    let Some(axis) = axis else {
        return false;
    };
    let (one, other) = (
        counterclockwise(seen(one, axis)),
        counterclockwise(seen(other, axis)),
    );
    !has_outside(&one, &other) && !has_outside(&other, &one)
}

type Flat = [[f64; 2]; 3];

fn seen(corners: &Triangle, axis: usize) -> Flat {
    corners.map(|corner| [corner[(axis + 1) % 3], corner[(axis + 2) % 3]])
}

/// 1 where the corners go round against the clock, -1 with it, 0 on a line.
fn turn(&corners: &Flat) -> i8 {
    let [a, b, c] = corners.map(|[x, y]| Coord { x, y });
    sign(orient2d(a, b, c))
}

fn counterclockwise(corners: Flat) -> Flat {
    let [a, b, c] = corners;
    match turn(&corners) {
        -1 => [a, c, b],
        _ => corners,
    }
}

/// Whether all of `other` is beyond one of the edges, or on it.
fn has_outside(corners: &Flat, other: &Flat) -> bool {
    (0..3).any(|k| {
        let (from, to) = (corners[k], corners[(k + 1) % 3]);
        other.iter().all(|&point| turn(&[from, to, point]) <= 0)
    })
}
