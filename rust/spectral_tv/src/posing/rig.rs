//! The pieces of a pose that move rigidly, and the joints between them: a rig.

use std::collections::VecDeque;

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use ndarray::{Array2, ArrayView2};

use crate::discretization::Discretization;
use crate::error::{ArgumentError, Result, unusable_values};
use crate::memory::needs;
use crate::mesh::{TriangleMesh, components_of};
use crate::monitor::{Monitor, Stage};
use crate::operators::{element_stiffness, pin};
use crate::posing::handles::diagonal;
use crate::posing::model::{Corners, Model, Parameters, Role};
use crate::posing::motion::Motion;
use crate::posing::pieces::{motions, pieces};
use crate::posing::settings::Settings;
use crate::posing::state::{State, normalized};

/// How much nearness to the middle of a joint counts beside that both pieces agree there.
const MIDDLE: f64 = 0.05;
/// How far from that middle it may be, relative to the spread of the joint: where pieces also shift,
/// they agree far off.
const REACH: f64 = 0.5;
/// What keeps weights at 0 where no piece is connected, relative to the mass.
const DAMPING: f64 = 1e-9;

/// A rig of P pieces, the largest first.
#[derive(Debug, Clone)]
pub struct Rig {
    /// The piece of every vertex, `None` in joints, V.
    pub labels: Vec<Option<u32>>,
    /// How much each piece moves each vertex, (P, V): 1 within, smooth in joints. Columns sum to 1.
    pub weights: Array2<f64>,
    /// How each piece is turned: unit quaternions w, x, y, z.
    pub rotations: Vec<[f64; 4]>,
    /// Where each piece's points go after that: R p + t, length.
    pub translations: Vec<[f64; 3]>,
    /// The piece that each hangs on; `None` for one that hangs on none.
    pub parents: Vec<Option<usize>>,
    /// The joint of each with its parent at rest, or the middle of one that hangs on none, length.
    pub heads: Vec<[f64; 3]>,
    /// The far end of each piece, seen from its head, length. Where one hangs on none, the joint of
    /// the largest that hangs on it.
    pub tails: Vec<[f64; 3]>,
}

/// Finds the pieces of a pose of `mesh`: its `displacement`, (3, V), length, and `rotations` as unit
/// quaternions, (4, V), as [`crate::posing::Pose`] has them. The piece that moves least is the root.
///
/// # Errors
/// If the arrays are not of the mesh, or not finite; [`crate::Error::Memory`].
pub fn rig(
    mesh: &TriangleMesh,
    displacement: ArrayView2<f64>,
    rotations: ArrayView2<f64>,
) -> Result<Rig> {
    rig_with(mesh, displacement, rotations, Monitor::new().whole())
}

/// [`rig`], watched: `stage` cancels it.
///
/// # Errors
/// As [`rig`], or [`crate::Error::Cancelled`].
pub fn rig_with(
    mesh: &TriangleMesh,
    displacement: ArrayView2<f64>,
    rotations: ArrayView2<f64>,
    stage: Stage,
) -> Result<Rig> {
    let count = mesh.vertex_count();
    for (name, array, rows) in [
        ("displacement", displacement, 3),
        ("rotations", rotations, 4),
    ] {
        if array.dim() != (rows, count) || unusable_values(array).is_some() {
            return Err(ArgumentError::contradiction(
                name,
                &["mesh"],
                format!("{name} must be {rows} finite numbers for each of the {count} vertices"),
            )
            .into());
        }
    }
    let needed = needs::deformation(needs::Size::of(mesh));
    let advice = "take a mesh of fewer vertices";
    stage.require(
        needed,
        &format!("finding a rig of {count} vertices"),
        advice,
    )?;
    let rest: Vec<Vector3<f64>> = mesh.vertices().iter().map(|&p| p.into()).collect();
    let state = state_of(&rest, displacement, rotations);
    let model = free(mesh, rest, stage)?;
    let labels = stage.pass(|| pieces(mesh, &model, &state))?;
    let motions = motions(mesh, &model, &state, &labels);
    let found = motions.len();
    let parents = parents(mesh, &model.rest, &labels, &motions);
    let weights = weights(&model, &labels, found, stage)?;
    let heads: Vec<Vector3<f64>> = (0..found)
        .map(|piece| head(mesh, &model.rest, &weights, &motions, &parents, piece))
        .collect();
    let tails = (0..found).map(|piece| match first_child(&parents, piece) {
        Some(child) if parents[piece].is_none() => heads[child],
        _ => tail(&model.rest, &labels, heads[piece], piece as u32),
    });
    Ok(Rig {
        tails: tails.map(Into::into).collect(),
        heads: heads.into_iter().map(Into::into).collect(),
        rotations: motions
            .iter()
            .map(|motion| {
                let q = motion.rotation;
                [q.w, q.i, q.j, q.k]
            })
            .collect(),
        translations: motions
            .iter()
            .map(|motion| motion.translation.into())
            .collect(),
        parents,
        weights,
        labels,
    })
}

fn state_of(
    rest: &[Vector3<f64>],
    displacement: ArrayView2<f64>,
    rotations: ArrayView2<f64>,
) -> State {
    let at = |v: usize| rest[v] + Vector3::from_fn(|axis, _| displacement[[axis, v]]);
    let turned = |v: usize| {
        let part = |k: usize| rotations[[k, v]];
        normalized(Quaternion::new(part(0), part(1), part(2), part(3)))
    };
    State {
        positions: (0..rest.len()).map(at).collect(),
        rotations: (0..rest.len()).map(turned).collect(),
        bodies: Vec::new(),
    }
}

/// The mesh without handles, with the parameters by which joints are told from pieces.
fn free(mesh: &TriangleMesh, rest: Vec<Vector3<f64>>, stage: Stage) -> Result<Model> {
    Ok(Model {
        roles: vec![Role::Free; rest.len()],
        arms: Vec::new(),
        pulled_along: Vec::new(),
        body_count: 0,
        corners: Corners::new(rest.len(), mesh.triangles(), stage)?,
        parameters: Parameters::new(&Settings::default(), diagonal(&rest)),
        operators: Discretization::new_with(mesh, stage)?,
        rest,
    })
}

/// What each piece hangs on, over joints, from the pieces on that move least.
fn parents(
    mesh: &TriangleMesh,
    rest: &[Vector3<f64>],
    labels: &[Option<u32>],
    motions: &[Motion],
) -> Vec<Option<usize>> {
    let mut moved = vec![0.0; motions.len()];
    let mut sizes = vec![0.0; motions.len()];
    for (v, label) in labels.iter().enumerate() {
        if let Some(piece) = label.map(|piece| piece as usize) {
            let area = mesh.vertex_areas()[v];
            moved[piece] += area * motions[piece].applied(&rest[v]).metric_distance(&rest[v]);
            sizes[piece] += area;
        }
    }
    let mut order: Vec<usize> = (0..motions.len()).collect();
    order.sort_by(|&a, &b| (moved[a] / sizes[a]).total_cmp(&(moved[b] / sizes[b])));
    let neighbours = neighbours(mesh, labels, motions.len());
    let mut parents = vec![None; motions.len()];
    let mut is_known = vec![false; motions.len()];
    for root in order {
        if std::mem::replace(&mut is_known[root], true) {
            continue;
        }
        let mut queue = VecDeque::from([root]);
        while let Some(piece) = queue.pop_front() {
            for &other in &neighbours[piece] {
                if !std::mem::replace(&mut is_known[other], true) {
                    parents[other] = Some(piece);
                    queue.push_back(other);
                }
            }
        }
    }
    parents
}

/// The pieces that each is connected with by a joint, or by an edge.
fn neighbours(mesh: &TriangleMesh, labels: &[Option<u32>], count: usize) -> Vec<Vec<usize>> {
    let between: Vec<[u32; 3]> = mesh
        .triangles()
        .iter()
        .zip(mesh.face_areas())
        .filter(|(_, area)| **area > 0.0)
        .map(|(corners, _)| *corners)
        .collect();
    let is_joint = |corners: &[u32; 3]| corners.iter().all(|&v| labels[v as usize].is_none());
    let joints: Vec<[u32; 3]> = between.iter().copied().filter(is_joint).collect();
    let zones = components_of(labels.len(), &joints, &vec![1.0; joints.len()]);
    // Which pieces each joint touches; edges between pieces are joints of their own.
    let mut touching: Vec<Vec<usize>> = vec![Vec::new(); labels.len()];
    let mut neighbours = vec![Vec::new(); count];
    for corners in &between {
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            let (a, b) = (corners[i] as usize, corners[j] as usize);
            match (labels[a], labels[b]) {
                (Some(piece), None) => touching[zones[b] as usize].push(piece as usize),
                (None, Some(piece)) => touching[zones[a] as usize].push(piece as usize),
                (Some(one), Some(other)) if one != other => {
                    neighbours[one as usize].push(other as usize);
                    neighbours[other as usize].push(one as usize);
                }
                _ => {}
            }
        }
    }
    for mut pieces in touching {
        pieces.sort_unstable();
        pieces.dedup();
        for &one in &pieces {
            neighbours[one].extend(pieces.iter().filter(|&&other| other != one));
        }
    }
    for list in &mut neighbours {
        list.sort_unstable();
        list.dedup();
    }
    neighbours
}

/// Harmonic functions that are 1 on a piece and 0 on all others, (P, V).
fn weights(
    model: &Model,
    labels: &[Option<u32>],
    count: usize,
    stage: Stage,
) -> Result<Array2<f64>> {
    let operators = &model.operators;
    let gradient = operators.gradient();
    let mut weights = Array2::zeros((count, labels.len()));
    for (v, label) in labels.iter().enumerate() {
        if let Some(piece) = label {
            weights[[*piece as usize, v]] = 1.0;
        }
    }
    if count == 0 || labels.iter().all(Option::is_some) {
        return Ok(weights);
    }
    let fixed: Vec<bool> = labels.iter().map(Option::is_some).collect();
    let ones = vec![1.0; gradient.face_areas().len()];
    let mut forces = Array2::zeros(weights.dim());
    for (mut force, own) in forces.rows_mut().into_iter().zip(weights.rows()) {
        let products = gradient.weighted_laplacian(&ones, own);
        for (v, product) in products.into_iter().enumerate() {
            force[v] = if fixed[v] { 0.0 } else { -product };
        }
    }
    let scale = operators.area().recip();
    let diagonal: Vec<f64> = operators
        .masses()
        .iter()
        .map(|m| DAMPING * scale * m)
        .collect();
    let mut system = operators.pattern().zeros();
    let stiffness =
        |face: usize| element_stiffness(&gradient.hats(face), gradient.face_areas()[face]);
    operators
        .pattern()
        .assemble(gradient, &diagonal, stiffness, &mut system);
    pin(&fixed, &mut system);
    let mut cholesky = operators.cholesky(stage)?;
    cholesky.factorize(&system, stage)?;
    cholesky.solve_in_place(&mut forces);
    weights += &forces;
    for mut column in weights.columns_mut() {
        // Obtuse triangles take them a little below 0.
        column.mapv_inplace(|weight| weight.clamp(0.0, 1.0));
        let sum = column.sum();
        match sum > 0.5 {
            true => column /= sum,
            // In no piece's reach: it stays with the largest.
            false => column[0] += 1.0 - sum,
        }
    }
    Ok(weights)
}

/// The largest piece that hangs on one.
fn first_child(parents: &[Option<usize>], piece: usize) -> Option<usize> {
    parents.iter().position(|&parent| parent == Some(piece))
}

/// Where a piece and its parent agree, near the middle of what is between them.
fn head(
    mesh: &TriangleMesh,
    rest: &[Vector3<f64>],
    weights: &Array2<f64>,
    motions: &[Motion],
    parents: &[Option<usize>],
    piece: usize,
) -> Vector3<f64> {
    // By faces: a joint may be as narrow as one.
    let of = |piece: usize, corners: &[u32; 3]| -> f64 {
        corners.iter().map(|&v| weights[[piece, v as usize]]).sum()
    };
    let faces = || mesh.triangles().iter().zip(mesh.face_areas());
    let shares = |parent: Option<usize>| -> Vec<(f64, Vector3<f64>)> {
        let share = |(corners, area): (&[u32; 3], &f64)| {
            let other = parent.map_or(1.0, |parent| of(parent, corners));
            let middle = corners.iter().map(|&v| rest[v as usize] / 3.0).sum();
            (area * of(piece, corners) * other, middle)
        };
        faces().map(share).filter(|share| share.0 > 0.0).collect()
    };
    let mut shared = shares(parents[piece]);
    if shared.is_empty() {
        shared = shares(None);
    }
    let total: f64 = shared.iter().map(|share| share.0).sum();
    let middle: Vector3<f64> = shared
        .iter()
        .map(|(share, point)| share / total * point)
        .sum();
    let Some(parent) = parents[piece] else {
        return middle;
    };
    let Motion {
        rotation,
        translation,
    } = Motion::to(&motions[parent], &motions[piece]);
    // x = R x + t for what the parent has moved already: the axis of the hinge.
    let moved = motions[parent].applied(&middle);
    let turn = UnitQuaternion::from_quaternion(rotation).to_rotation_matrix();
    let turn = turn.matrix() - Matrix3::identity();
    let nearness = MIDDLE * 0.5 * turn.norm_squared() + f64::MIN_POSITIVE;
    let matrix = turn.transpose() * turn + Matrix3::from_diagonal_element(nearness);
    let side = -turn.transpose() * translation + nearness * moved;
    let found = matrix
        .cholesky()
        .map_or(moved, |cholesky| cholesky.solve(&side));
    let back = motions[parent].to(&Motion::none());
    let off = back.applied(&found) - middle;
    let apart =
        |(share, point): &(f64, Vector3<f64>)| share / total * (point - middle).norm_squared();
    let reach = REACH * shared.iter().map(apart).sum::<f64>().sqrt();
    middle + off * (reach / off.norm().max(f64::MIN_POSITIVE)).min(1.0)
}

/// The point in the direction of a piece's middle that is as far as its farthest vertex.
fn tail(
    rest: &[Vector3<f64>],
    labels: &[Option<u32>],
    head: Vector3<f64>,
    piece: u32,
) -> Vector3<f64> {
    let own = || (0..rest.len()).filter(|&v| labels[v] == Some(piece));
    let count = own().count() as f64;
    let middle: Vector3<f64> = own().map(|v| rest[v] / count).sum();
    let along = (middle - head)
        .try_normalize(0.0)
        .unwrap_or_else(Vector3::z);
    let far = own()
        .map(|v| along.dot(&(rest[v] - head)))
        .fold(0.0, f64::max);
    head + far * along
}
