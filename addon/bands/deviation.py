"""How far bands move the vertices of an object: from the shape that is shown without them."""

from __future__ import annotations

from collections.abc import Collection
from functools import cached_property

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np

from ..scene import mix
from ..scene.coordinates import triangles
from ..scene.keeping import Band
from ..scene.normals import vertex_normals


@dataclass(frozen=True)
class Deviation:
    """Lengths are in the unit of the scene, with the rotation and scale of the object applied.

    ``original`` (V, 3) is shown without the bands, ``moved`` (V, 3) is what they add; ``faces``
    (F, 3) are the triangles. ``is_mirrored`` tells whether the scale turns the faces over.
    """

    original: np.ndarray
    moved: np.ndarray
    faces: np.ndarray
    is_mirrored: bool

    @classmethod
    def of(
        cls, obj: bpy.types.Object, bands: Collection[Band], moves: mix.Moves | None = None
    ) -> Deviation:
        """Read it as shape keys show it, before modifiers."""
        matrix = matrix_of(obj)
        parts = [part for part in mix.parts(obj) if part.key in bands]
        moved = (moves or mix.Moves()).of(obj, parts)
        return cls(
            mix.shown(obj, without=bands) @ matrix.T,
            moved @ matrix.T,
            triangles(obj.data),
            bool(np.linalg.det(matrix) < 0),
        )

    @cached_property
    def lengths(self) -> np.ndarray:
        """How far each vertex is moved, (V,)."""
        return np.linalg.norm(self.moved, axis=1)

    @cached_property
    def signed(self) -> np.ndarray:
        """The same, negative where it is moved inwards, (V,)."""
        along = np.einsum("ij,ij->i", self.moved, vertex_normals(self.original, self.faces))
        inwards = along > 0 if self.is_mirrored else along < 0
        return np.where(inwards, -self.lengths, self.lengths)


def matrix_of(obj: bpy.types.Object) -> np.ndarray:
    """The rotation and scale of an object in the world, (3, 3)."""
    return np.array(obj.matrix_world.to_3x3(), dtype=np.float64)
