//! A mesh and a displacement of its vertices.

use std::borrow::Cow;
use std::ops::Range;

use ndarray::ArrayView2;

use crate::error::{ArgumentError, Error, Result, has_usable_size, unusable_values};
use crate::guard::face::Face;
use crate::guard::screen::{BLOCK, Block, Screen};
use crate::mesh::{TriangleMesh, repeats_an_index};
use crate::parallel;

/// Vectors, one for each vertex.
type Rows<'a> = Cow<'a, [[f64; 3]]>;

/// A mesh, and by what each of its vertices moves.
pub(super) struct Displaced<'a> {
    pub mesh: &'a TriangleMesh,
    pub shifts: Rows<'a>,
}

impl<'a> Displaced<'a> {
    /// Of a displacement (3, V).
    ///
    /// # Errors
    /// Names the shape, or the first vertex and axis that is not finite, or beyond 1e100.
    pub fn new(mesh: &'a TriangleMesh, displacement: ArrayView2<'a, f64>) -> Result<Self> {
        let (rows, columns) = displacement.dim();
        if rows != 3 || columns != mesh.vertex_count() {
            return Err(ArgumentError::contradiction(
                "displacement",
                &["mesh"],
                format!(
                    "displacement must have a vector of 3 for every vertex ({}), but has {columns} \
                     of {rows}",
                    mesh.vertex_count()
                ),
            )
            .into());
        }
        let shifts = vectors(displacement);
        let parts = parallel::parts(shifts.len(), |part| {
            let mut values = shifts[part].as_flattened().iter();
            values.all(|&value| has_usable_size(value))
        });
        if let Some((vertices, channel, value)) = parts
            .contains(&false)
            .then(|| unusable_values(displacement))
            .flatten()
        {
            return Err(Error::NonFiniteValues {
                vertices,
                channel,
                value,
            });
        }
        Ok(Self { mesh, shifts })
    }

    /// Does `work` on those `faces` that are on the screen, with other shifts than those given. The
    /// screen may be changed for the faces that follow.
    pub fn for_each_face(
        &self,
        faces: Range<usize>,
        shifts: &[[f64; 3]],
        mut screen: Screen,
        mut work: impl FnMut(usize, &Face, &mut Screen),
    ) {
        let (vertices, triangles) = (self.mesh.vertices(), self.mesh.triangles());
        let mut block = Block::new();
        let end = faces.end;
        for first in faces.step_by(BLOCK) {
            let some = &triangles[first..end.min(first + BLOCK)];
            for (place, &corners) in some.iter().enumerate() {
                block.set(place, at(vertices, corners), at(shifts, corners));
            }
            let excess = screen.judge(&block);
            // Whatever is not known to be calm is shown, NaN too.
            let is_calm = |place: &usize| excess[*place] <= 0.0;
            let shown = (0..some.len()).filter(|place| !is_calm(place));
            for place in shown {
                let corners = some[place];
                if repeats_an_index(&corners) {
                    continue;
                }
                if let Some(face) = Face::new(at(vertices, corners), at(shifts, corners)) {
                    work(first + place, &face, &mut screen);
                }
            }
        }
    }
}

/// What a face's corners have.
#[inline]
fn at(values: &[[f64; 3]], [i, j, k]: [u32; 3]) -> [&[f64; 3]; 3] {
    [
        &values[i as usize],
        &values[j as usize],
        &values[k as usize],
    ]
}

/// An array (3, V) as vectors: itself where they lie in memory so.
fn vectors(array: ArrayView2<f64>) -> Rows {
    match array.reversed_axes().to_slice() {
        Some(rows) => rows.as_chunks::<3>().0.into(),
        None => {
            let [x, y, z] = [0, 1, 2].map(|axis| array.row(axis));
            parallel::values(array.ncols(), |v| [x[v], y[v], z[v]]).into()
        }
    }
}
