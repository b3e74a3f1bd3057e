//! Facts of the energy and its solver.

use nalgebra::{Quaternion, Vector3};

use crate::deformation::{self, Constraints, deform};
use crate::mesh::TriangleMesh;
use crate::monitor::Monitor;
use crate::posing::current::Current;
use crate::posing::field::Field;
use crate::posing::handles::Handles;
use crate::posing::levels::Levels;
use crate::posing::linearized::Linearized;
use crate::posing::model::Parameters;

use crate::posing::poser::pose;
use crate::posing::rig::rig;
use crate::posing::settings::Settings;
use crate::posing::state::rotated;

/// A strip of `length` squares, one high, in the plane.
fn strip(length: usize) -> TriangleMesh {
    let vertices = (0..2 * (length + 1)).map(|v| [(v / 2) as f64, (v % 2) as f64, 0.0]);
    let triangles = (0..length as i64).flat_map(|square| {
        let first = 2 * square;
        [
            [first, first + 2, first + 1],
            [first + 1, first + 2, first + 3],
        ]
    });
    TriangleMesh::new(vertices.collect(), &triangles.collect::<Vec<_>>()).unwrap()
}

/// Handles of all kinds on a strip, and a state that is far from rest, some faces crushed.
fn bent() -> (Levels, Current) {
    let mesh = strip(6);
    let indices = [0, 1, 2, 12, 13, 6, 9, 7];
    let bodies = [-1, -1, -1, 0, 0, 0, -1, -1];
    let weights = [1.0, 1.0, 1.0, 1.0, 1.0, 0.4, 0.3, 1.0];
    let handles = Handles::new(&mesh, &indices, Some(&weights), Some(&bodies)).unwrap();
    let targets: Vec<[f64; 3]> = indices
        .iter()
        .map(|&v| {
            let [x, y, z] = mesh.vertices()[v as usize];
            [0.6 * x, y, z + 0.2 * x]
        })
        .collect();
    let parameters = Parameters::new(&Settings::default(), handles.diagonal());
    let stage = Monitor::new();
    let levels = Levels::new(&mesh, &handles, parameters, stage.whole()).unwrap();
    let mut current = Current::at_rest(&handles);
    (current.goals, current.motion) = handles.goals(&targets).unwrap();
    let mut random = fastrand::Rng::with_seed(5);
    let mut field = some(&levels, &mut random);
    levels.fine.expand(&current.state, &mut field);
    current.state = levels
        .fine
        .moved(&current.state, &field, 0.7, &current.goals);
    (levels, current)
}

fn some(levels: &Levels, random: &mut fastrand::Rng) -> Field {
    let mut vector = || Vector3::from_fn(|_, _| random.f64() - 0.5);
    let vertices = levels.fine.rest.len();
    let mut field = Field::zeros(vertices, levels.fine.body_count);
    for v in 0..vertices {
        field.moves[v] = vector();
        field.turns[v] = vector();
    }
    for body in &mut field.bodies {
        *body = vector();
    }
    field
}

fn is_crushed_somewhere(linearized: &Linearized) -> bool {
    let mut faces = linearized.numbers.faces.iter();
    faces.any(|face| face.crushed.is_some())
}

#[test]
fn the_gradient_is_that_of_the_energy() {
    let (levels, current) = bent();
    let (fine, state, goals) = (&levels.fine, &current.state, &current.goals);
    let linearized = Linearized::new(fine, state, goals);
    assert!(is_crushed_somewhere(&linearized));
    assert!((linearized.numbers.value / fine.value(state, goals) - 1.0).abs() < 1e-12);
    let mut random = fastrand::Rng::with_seed(9);
    for _ in 0..5 {
        let mut field = some(&levels, &mut random);
        let slope = {
            let mut free = field.clone();
            let bodies = free.bodies.clone();
            fine.reduce(state, &mut free);
            free.bodies = bodies;
            linearized.numbers.gradient.dot(&free)
        };
        fine.expand(state, &mut field);
        let at = |length: f64| fine.value(&fine.moved(state, &field, length, goals), goals);
        let step = 1e-5;
        let difference = (at(step) - at(-step)) / (2.0 * step);
        assert!(
            (slope - difference).abs() < 1e-6 * slope.abs().max(1.0),
            "{slope} {difference}"
        );
    }
}

#[test]
fn the_factorized_matrix_is_the_one_that_is_applied() {
    let (mut levels, current) = bent();
    let before = levels.lift.injected(&current.state);
    let goals = levels.coarse_goals(&current.goals);
    // With crushed faces, which a coarse mesh has none of otherwise.
    levels.coarse.parameters = levels.fine.parameters;
    let linearized = Linearized::new(&levels.coarse, &before, &goals);
    assert!(is_crushed_somewhere(&linearized));
    levels
        .system
        .factorize(&linearized, Monitor::new().whole())
        .unwrap();
    let mut random = fastrand::Rng::with_seed(2);
    let mut field = some(&levels, &mut random);
    let bodies = field.bodies.clone();
    levels.coarse.reduce(&before, &mut field);
    field.bodies = bodies;
    let image = linearized.apply(&field);
    let mut found = levels.system.solve(&image, &levels.coarse);
    found.add(-1.0, &field);
    assert!(found.dot(&found) < 1e-10 * field.dot(&field));
}

/// Two discs in the plane, joined by a bar.
fn dumbbell() -> TriangleMesh {
    let (columns, rows) = (21, 7);
    let at = |column: usize, row: usize| {
        let x = column as f64 / (columns - 1) as f64 * 4.0 - 2.0;
        let wide = if x.abs() > 0.6 { 1.0 } else { 0.25 };
        [x, (row as f64 / (rows - 1) as f64 - 0.5) * wide, 0.0]
    };
    let vertices = (0..columns * rows).map(|v| at(v / rows, v % rows));
    let triangles = (0..columns - 1).flat_map(|column| {
        (0..rows - 1).flat_map(move |row| {
            let first = (column * rows + row) as i64;
            let next = first + rows as i64;
            [[first, next, first + 1], [first + 1, next, next + 1]]
        })
    });
    TriangleMesh::new(vertices.collect(), &triangles.collect::<Vec<_>>()).unwrap()
}

#[test]
fn without_turns_it_is_the_convex_problem() {
    let mesh = dumbbell();
    let ends = |v: &usize| mesh.vertices()[*v][0].abs() > 1.75;
    let held: Vec<usize> = (0..mesh.vertex_count()).filter(ends).collect();
    let indices: Vec<i64> = held.iter().map(|&v| v as i64).collect();
    let targets: Vec<[f64; 3]> = held
        .iter()
        .map(|&v| {
            let [x, y, z] = mesh.vertices()[v];
            if x > 0.0 {
                [x + 0.3, y + 0.1, z + 0.4]
            } else {
                [x, y, z]
            }
        })
        .collect();
    let exact = deformation::Settings {
        tolerance: 1e-4,
        ..Default::default()
    };
    let constraints = Constraints::new(&mesh, &indices, None).unwrap();
    let convex = deform(&mesh, constraints, &targets, exact).unwrap();
    let handles = Handles::new(&mesh, &indices, None, None).unwrap();
    let settings = Settings {
        joint_softness: 0.0,
        stiffness: 1e3,
        stillness: 0.0,
    };
    let mut parameters = Parameters::new(&settings, handles.diagonal());
    parameters.unstrained = 1e-10;
    let stage = Monitor::new();
    let mut levels = Levels::new(&mesh, &handles, parameters, stage.whole()).unwrap();
    let mut current = Current::at_rest(&handles);
    current
        .cycle(&mut levels, &handles, &targets, stage.whole())
        .unwrap();
    for _ in 0..200 {
        if current.newton(&mut levels, 1e-7, stage.whole()).unwrap().0 < 1e-6 {
            break;
        }
    }
    let value = levels.fine.value(&current.state, &current.goals);
    let least = convex.total_variation * (1.0 - convex.gap);
    assert!((value / least - 1.0).abs() < 1e-3, "{value} {least}");
}

#[test]
fn a_bent_dumbbell_is_two_pieces_with_a_joint_between() {
    let mesh = dumbbell();
    let vertices = mesh.vertices();
    let held: Vec<usize> = (0..vertices.len())
        .filter(|&v| vertices[v][0].abs() > 1.5)
        .collect();
    let indices: Vec<i64> = held.iter().map(|&v| v as i64).collect();
    let bodies: Vec<i64> = held
        .iter()
        .map(|&v| if vertices[v][0] > 0.0 { 0 } else { -1 })
        .collect();
    let lifted = |v: &usize| {
        let [x, y, z] = vertices[*v];
        if x > 0.0 {
            [x - 0.4, y, z + 1.0]
        } else {
            [x, y, z]
        }
    };
    let targets: Vec<[f64; 3]> = held.iter().map(lifted).collect();
    let handles = Handles::new(&mesh, &indices, None, Some(&bodies)).unwrap();
    let posed = pose(&mesh, handles, &targets, Settings::default(), 1e-4).unwrap();
    let found = rig(&mesh, posed.displacement.view(), posed.rotations.view()).unwrap();
    assert_eq!(found.rotations.len(), 2);
    let root = found.parents.iter().position(Option::is_none).unwrap();
    let arm = 1 - root;
    assert_eq!(found.parents[arm], Some(root));
    let [x, y, _] = found.heads[arm];
    assert!(x.abs() < 0.8 && y.abs() < 0.1, "{:?}", found.heads[arm]);
    assert!(found.tails[arm][0] > 1.5);
    for column in found.weights.columns() {
        assert!((column.sum() - 1.0).abs() < 1e-12);
        assert!(column.iter().all(|&weight| weight >= 0.0));
    }
    // Bones that turn so carry the mesh to about where the pose has it.
    let moved = |v: usize, piece: usize| {
        let [w, i, j, k] = found.rotations[piece];
        let turn = Quaternion::new(w, i, j, k);
        rotated(&turn, &vertices[v].into()) + Vector3::from(found.translations[piece])
    };
    for (v, vertex) in vertices.iter().enumerate() {
        let blended: Vector3<f64> = (0..2).map(|p| found.weights[[p, v]] * moved(v, p)).sum();
        let goal =
            Vector3::from(*vertex) + Vector3::from_fn(|axis, _| posed.displacement[[axis, v]]);
        assert!((blended - goal).norm() < 0.1, "{v}");
    }
}
