//! Smaller problems within that of a mesh: on some of its triangles, or with parts that move as wholes.

use std::collections::HashMap;

use crate::discretization::Discretization;
use crate::error::Result;
use crate::monitor::Stage;
use crate::operators::{FaceVector, Gradient, invertible_masses};

impl Discretization {
    /// The operators of some of the triangles by themselves, `faces`, and which unknowns these have, in
    /// the order that they have there. The mass is lumped.
    ///
    /// # Errors
    /// As [`Self::new_with`].
    pub(crate) fn on_faces(&self, faces: &[u32], stage: Stage) -> Result<(Self, Vec<u32>)> {
        let mut numbers = HashMap::new();
        let mut unknowns = Vec::new();
        let number = |unknown: u32| {
            *numbers.entry(unknown).or_insert_with(|| {
                unknowns.push(unknown);
                unknowns.len() as u32 - 1
            })
        };
        let (triangles, hats, areas) = self.renumbered(faces, number);
        let mut masses = vec![0.0; unknowns.len()];
        for (triangle, area) in triangles.iter().zip(&areas) {
            for &unknown in triangle {
                masses[unknown as usize] += area / 3.0;
            }
        }
        let area = areas.iter().sum();
        let gradient =
            Gradient::of_functions(later(&hats), triangles.into(), areas.into(), unknowns.len());
        let operators = Self::of_parts(gradient, invertible_masses(&masses), area, stage)?;
        Ok((operators, unknowns))
    }

    /// The operators of functions that are constant on parts: `numbers` (N) says which of `count` parts
    /// each unknown is in. `faces` are the triangles whose unknowns are not all in one part.
    ///
    /// # Errors
    /// As [`Self::new_with`].
    pub(crate) fn with_rigid_parts(
        &self,
        faces: &[u32],
        numbers: &[u32],
        count: usize,
        stage: Stage,
    ) -> Result<Self> {
        let (triangles, mut hats, areas) =
            self.renumbered(faces, |unknown| numbers[unknown as usize]);
        for (triangle, hats) in triangles.iter().zip(&mut hats) {
            merge_functions(triangle, hats);
        }
        let hats = later(&hats);
        let mut masses = vec![0.0; count];
        for (&number, mass) in numbers.iter().zip(&self.masses) {
            masses[number as usize] += mass;
        }
        let coupling = |&face: &u32| self.couplings[face as usize];
        let couplings = match self.couplings.is_empty() {
            true => Vec::new(),
            false => faces.iter().map(coupling).collect(),
        };
        let gradient = Gradient::of_functions(hats, triangles.into(), areas.into(), count);
        Ok(Self {
            couplings,
            ..Self::of_parts(gradient, masses, self.area, stage)?
        })
    }

    /// Unknowns, gradients and areas of some of the triangles, with the `number` of each unknown.
    fn renumbered(
        &self,
        faces: &[u32],
        mut number: impl FnMut(u32) -> u32,
    ) -> (Vec<[u32; 3]>, Vec<[FaceVector; 3]>, Vec<f64>) {
        let gradient = &self.gradient;
        let faces = faces.iter().map(|&face| face as usize);
        let triangles = faces
            .clone()
            .map(|face| gradient.triangles()[face].map(&mut number));
        (
            triangles.collect(),
            faces.clone().map(|face| gradient.hats(face)).collect(),
            faces.map(|face| gradient.face_areas()[face]).collect(),
        )
    }
}

/// What a gradient is made of.
fn later(hats: &[[FaceVector; 3]]) -> Vec<[FaceVector; 2]> {
    hats.iter().map(|&[_, j, k]| [j, k]).collect()
}

/// Where one unknown stands at several places of a triangle, the first of them takes over the functions
/// of all, so that no product of different places is one of an unknown with itself.
fn merge_functions(triangle: &[u32; 3], hats: &mut [FaceVector; 3]) {
    for (first, later) in [(0, 1), (0, 2), (1, 2)] {
        if triangle[first] == triangle[later] {
            let [x, y] = std::mem::take(&mut hats[later]);
            hats[first][0] += x;
            hats[first][1] += y;
        }
    }
}
