//! Poses, at once and by dragging.

use arbitrary::{Arbitrary, Result, Unstructured};
use spectral_tv::mesh::TriangleMesh;
use spectral_tv::posing::{Handles, Pose, Poser, Settings, pose};

use crate::number::{number, numbers, tolerance};
use crate::pulls::Pulls;
use crate::{assert_finite, unless_refused};

/// What is pulled, some of it as bodies that turn.
#[derive(Debug, Arbitrary)]
struct Grips {
    pulls: Pulls,
    bodies: Option<[i8; 6]>,
}

impl Grips {
    /// One number for each entry, mostly of few bodies.
    fn bodies(&self, mesh: &TriangleMesh) -> Option<Vec<i64>> {
        let numbers = self.bodies?;
        let count = self.pulls.indices(mesh).len();
        let number = |number: &i8| match *number {
            i8::MIN => -2,
            number => i64::from(number.rem_euclid(4)) - 1,
        };
        Some(numbers.iter().take(count).map(number).collect())
    }

    fn handles(&self, mesh: &TriangleMesh) -> Option<Handles> {
        let (indices, weights) = (self.pulls.indices(mesh), self.pulls.weights());
        let bodies = self.bodies(mesh);
        unless_refused(Handles::new(
            mesh,
            &indices,
            Some(&weights),
            bodies.as_deref(),
        ))
    }

    fn check(&self, mesh: &TriangleMesh, targets: &[[f64; 3]], posed: &Pose) {
        assert_finite("displacement", &posed.displacement);
        assert_finite("rotations", &posed.rotations);
        for rotation in posed.rotations.columns() {
            let norm = rotation.dot(&rotation).sqrt();
            assert!((norm - 1.0).abs() < 1e-6, "a quaternion of length {norm}");
        }
        assert_finite("energy and movement", [&posed.energy, &posed.movement]);
        assert!(posed.energy >= 0.0 && posed.movement >= 0.0);
        assert!(posed.decrement.is_none_or(|decrement| decrement >= 0.0));
        let bodies = self.bodies(mesh);
        let is_fixed = |entry: usize| bodies.as_ref().is_none_or(|bodies| bodies[entry] == -1);
        let displacement = &posed.displacement;
        self.pulls.assert_met(mesh, targets, displacement, is_fixed);
    }
}

fn settings(input: &mut Unstructured) -> Result<Settings> {
    let default = Settings::default();
    let mut one = |usual| match input.ratio(1, 3)? {
        true => number(input),
        false => Ok(usual),
    };
    Ok(Settings {
        joint_softness: one(default.joint_softness)?,
        stiffness: one(default.stiffness)?,
        stillness: one(default.stillness)?,
    })
}

/// A pose from rest.
#[derive(Debug, Arbitrary)]
pub struct PoseOnce {
    grips: Grips,
    #[arbitrary(with = settings)]
    settings: Settings,
    #[arbitrary(with = tolerance)]
    tolerance: f64,
}

impl PoseOnce {
    pub fn run(&self, mesh: &TriangleMesh) {
        let Some(handles) = self.grips.handles(mesh) else {
            return;
        };
        let targets = self.grips.pulls.positions(mesh, 1.0);
        let outcome = pose(mesh, handles, &targets, self.settings, self.tolerance);
        if let Some(posed) = unless_refused(outcome) {
            self.grips.check(mesh, &targets, &posed);
        }
    }
}

/// A poser that is dragged, takes other parameters, and then solves.
#[derive(Debug, Arbitrary)]
pub struct Drag {
    grips: Grips,
    #[arbitrary(with = settings)]
    first: Settings,
    #[arbitrary(with = settings)]
    second: Settings,
    #[arbitrary(with = numbers)]
    shares: Vec<f64>,
}

impl Drag {
    pub fn run(&self, mesh: &TriangleMesh) {
        let Some(handles) = self.grips.handles(mesh) else {
            return;
        };
        let poser = Poser::new(mesh, handles, self.first);
        let Some(mut poser) = unless_refused(poser) else {
            return;
        };
        for &share in &self.shares {
            let targets = self.grips.pulls.positions(mesh, share);
            if let Some(posed) = unless_refused(poser.drag(&targets)) {
                self.grips.check(mesh, &targets, &posed);
            }
        }
        unless_refused(poser.set_settings(self.second));
        if let Some(state) = poser.state() {
            unless_refused(poser.set_state(state)).expect("its own state");
        }
        let positions = |share| self.grips.pulls.positions(mesh, share);
        let sequence = [0.5, 1.0, 0.0].map(positions);
        let outcome = poser.solve_sequence(&sequence, 1e-2);
        let found = unless_refused(outcome).unwrap_or_default();
        for (targets, posed) in sequence.iter().zip(found) {
            self.grips.check(mesh, targets, &posed);
        }
    }
}
