//! Faces that a displacement folds or stretches, and the gain up to which none does.

use std::ops::Range;

use ndarray::ArrayView2;

use crate::error::Result;
use crate::guard::displaced::Displaced;
use crate::guard::screen::{BLOCK, Screen};
use crate::guard::stretch::check_stretch;
use crate::memory::needs;
use crate::mesh::TriangleMesh;
use crate::monitor::{Monitor, Stage};
use crate::parallel;

/// One of so many faces is looked at first.
const SAMPLE: usize = 64;

/// What a displacement does to the faces of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Folds {
    /// Faces whose normals turn by over 90° against the mesh as it is, in order.
    pub flipped: Vec<usize>,
    /// Faces with an edge that becomes longer than the limit allows, in order.
    pub stretched: Vec<usize>,
    /// The largest length of an edge relative to what it was; 0 if no face has a size.
    pub largest_stretch: f64,
    /// The least positive gain of the displacement at which a face folds but for a margin, or an
    /// edge reaches the limit: below it nothing folds or stretches. Infinity if there is none.
    pub safe_gain: f64,
}

/// The faces of `mesh` that fold or stretch where its vertices move by `displacement` (3, V).
///
/// - A face folds where its normal turns by over 90° against the mesh as it is. The margin of the
///   safe gain is that a fifth of its area is left, as seen along its normal.
/// - A face is stretched where an edge becomes longer than `stretch` times its length. Edges may
///   become shorter: a face that collapses has reached the margin of folding before.
/// - A face that is lower than 1e-5 of its longest edge, such as one with no area, has no normal that
///   counts: it cannot fold. An edge that is shorter than that counts as if it were so long. A
///   face that repeats an index, or is no larger than a point, takes no part.
///
/// Takes some nanoseconds a face, so that it can follow a slider.
///
/// # Errors
/// If the displacement is not of this mesh or not finite, `stretch` is not above 1, or memory does
/// not suffice.
pub fn folds(mesh: &TriangleMesh, displacement: ArrayView2<f64>, stretch: f64) -> Result<Folds> {
    folds_with(mesh, displacement, stretch, Monitor::new().whole())
}

/// [`folds`], watched: `stage` cancels it.
///
/// # Errors
/// As [`folds`], or [`crate::Error::Cancelled`].
pub fn folds_with(
    mesh: &TriangleMesh,
    displacement: ArrayView2<f64>,
    stretch: f64,
    stage: Stage,
) -> Result<Folds> {
    check_stretch(stretch)?;
    stage.report(0.0)?;
    stage.claim(
        needs::folds(needs::Size::of(mesh)),
        &format!("looking at {} faces", mesh.triangles().len()),
        "take a mesh of fewer faces",
    )?;
    let displaced = Displaced::new(mesh, displacement)?;
    let count = mesh.triangles().len();
    // Faces that do no worse than these are passed over.
    let some = (0..count).step_by(SAMPLE * BLOCK);
    let some = some.map(|first| first..count.min(first + BLOCK));
    let some = some.fold(Part::new(stretch), |part, faces| {
        part.with(&displaced, faces)
    });
    let look = |faces| some.emptied().with(&displaced, faces);
    let parts = stage.pass(|| parallel::parts(count, look))?;
    stage.report(1.0)?;
    let faces = |of: fn(&Part) -> &Vec<usize>| parts.iter().flat_map(of).copied().collect();
    let largest = parts.iter().map(|part| part.squared_stretch);
    let safe = parts.iter().map(|part| part.safe_gain);
    Ok(Folds {
        flipped: faces(|part| &part.flipped),
        stretched: faces(|part| &part.stretched),
        largest_stretch: largest.fold(0.0, f64::max).sqrt(),
        safe_gain: safe.fold(f64::INFINITY, f64::min),
    })
}

/// The same of some faces.
struct Part {
    stretch: f64,
    flipped: Vec<usize>,
    stretched: Vec<usize>,
    squared_stretch: f64,
    safe_gain: f64,
}

impl Part {
    /// Of none.
    fn new(stretch: f64) -> Self {
        Self {
            stretch,
            flipped: Vec::new(),
            stretched: Vec::new(),
            squared_stretch: 0.0,
            safe_gain: f64::INFINITY,
        }
    }

    /// The same extremes without faces.
    fn emptied(&self) -> Self {
        Self {
            squared_stretch: self.squared_stretch,
            safe_gain: self.safe_gain,
            ..Self::new(self.stretch)
        }
    }

    fn with(mut self, displaced: &Displaced, faces: Range<usize>) -> Self {
        let screen = self.screen();
        displaced.for_each_face(faces, &displaced.shifts, screen, |index, face, screen| {
            if face.is_flipped() {
                self.flipped.push(index);
            }
            let square = face.squared_stretch();
            if square > self.stretch * self.stretch {
                self.stretched.push(index);
            }
            let safe_gain = face.safe_gain(self.stretch, self.safe_gain);
            if square > self.squared_stretch || safe_gain < self.safe_gain {
                self.squared_stretch = self.squared_stretch.max(square);
                self.safe_gain = safe_gain;
                *screen = self.screen();
            }
        });
        self
    }

    /// What faces have to do to add to what is known.
    fn screen(&self) -> Screen {
        Screen::new(self.stretch, self.safe_gain, self.squared_stretch.sqrt())
    }
}
