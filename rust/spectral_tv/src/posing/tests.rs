//! Facts of the energy and its solver.

use nalgebra::Vector3;

use crate::mesh::TriangleMesh;
use crate::monitor::Monitor;
use crate::posing::current::Current;
use crate::posing::field::Field;
use crate::posing::handles::Handles;
use crate::posing::levels::Levels;
use crate::posing::linearized::Linearized;
use crate::posing::model::Parameters;
use crate::posing::settings::Settings;

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
    let indices = [0, 1, 12, 13, 6, 9];
    let bodies = [-1, -1, 0, 0, 0, -1];
    let weights = [1.0, 1.0, 1.0, 1.0, 0.4, 0.3];
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
    let mut current = handles.at_rest();
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

#[test]
fn the_gradient_is_that_of_the_energy() {
    let (levels, current) = bent();
    let (fine, state, goals) = (&levels.fine, &current.state, &current.goals);
    let linearized = Linearized::new(fine, state, goals);
    assert!(linearized.faces.iter().any(|face| face.crushed.is_some()));
    assert!((linearized.value / fine.value(state, goals) - 1.0).abs() < 1e-12);
    let mut random = fastrand::Rng::with_seed(9);
    for _ in 0..5 {
        let mut field = some(&levels, &mut random);
        let slope = {
            let mut free = field.clone();
            let bodies = free.bodies.clone();
            fine.reduce(state, &mut free);
            free.bodies = bodies;
            linearized.gradient.dot(&free)
        };
        fine.expand(state, &mut field);
        let at = |length: f64| fine.value(&fine.moved(state, &field, length, goals), goals);
        let step = 1e-5;
        let difference = (at(step) - at(-step)) / (2.0 * step);
        assert!((slope - difference).abs() < 1e-6 * slope.abs().max(1.0), "{slope} {difference}");
    }
}
