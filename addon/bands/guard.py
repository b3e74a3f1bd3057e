"""What the bands of an object do to its faces: how many fold, and how many stretch beyond a limit.

It is told against the shape that is shown without bands: with them at 0, and the other shape keys
as they are.
"""

from __future__ import annotations

import warnings
from collections.abc import Collection, Iterable

import bpy
import spectral_tv
from spectral_tv.bands.counts import Counts
from spectral_tv.bands.guard import STRETCH
from spectral_tv.later import np

from ..scene import mix
from ..scene.arrays import numbers
from ..scene.coordinates import basis_coordinates, triangles
from ..scene.surface import NOWHERE

# By how much an object's scales along its axes may differ, relative to them, and count as one.
ROUNDING = 1e-6


class Reference:
    """The faces of an object in the shape without bands, which is read anew where it changed.

    A face counts if one of the triangles that it is drawn by folds or stretches. What is slow to
    read is kept: the weights of vertex groups until they are forgotten, the triangles as long as
    the faces are the same, and the shape as long as it is.
    """

    def __init__(self) -> None:
        """Know nothing so far."""
        self._moves = mix.Moves()
        self._corners: np.ndarray | None = None
        self._shape: np.ndarray | None = None

    def forget_masks(self) -> None:
        """Read the weights of vertex groups anew, as they may have changed."""
        self._moves.forget_masks()

    def counts(self, obj: bpy.types.Object, bands: Collection[bpy.types.ShapeKey]) -> Counts:
        """What the bands do at their present values.

        Raises spectral_tv.MeshError if that cannot be told.
        """
        moving = [part for part in mix.parts(obj) if part.key in bands]
        if not moving:
            return Counts()
        others = [part for part in mix.parts(obj) if part.key not in bands]
        self._take_triangles(obj.data)
        shape = basis_coordinates(obj.data) + self._moves.of(obj, others)
        self._take_shape(shape, distortion(obj))
        return self._found(self._moves.of(obj, moving), STRETCH)

    def counts_of(
        self, obj: bpy.types.Object, shape: np.ndarray, moves: Iterable[np.ndarray], stretch: float
    ) -> list[Counts]:
        """What each displacement (V, 3) of a shape (V, 3), in object space, does."""
        self._take_triangles(obj.data)
        self._take_shape(shape, distortion(obj))
        return [self._found(each, stretch) for each in moves]

    def _take_triangles(self, mesh: bpy.types.Mesh) -> None:
        corners = numbers(mesh.attributes[".corner_vert"].data, "value")
        if self._corners is None or not np.array_equal(corners, self._corners):
            self._corners = corners
            self._triangles = triangles(mesh)
            self._face_of = numbers(mesh.loop_triangles, "polygon_index")
            self._shape = None

    def _take_shape(self, shape: np.ndarray, matrix: np.ndarray | None) -> None:
        """Have a shape (V, 3) in object space be the one that is displaced."""
        is_same = self._shape is not None and np.array_equal(shape, self._shape, equal_nan=True)
        if is_same and np.array_equal(matrix, self._matrix):
            return
        self._shape, self._matrix = None, matrix
        # Faces without a place are nowhere to fold.
        self._is_there = (np.abs(shape) < NOWHERE).all(axis=1)
        seen = self._is_there[self._triangles].all(axis=1)
        self._faces = self._face_of[seen]
        positions = np.where(self._is_there[:, np.newaxis], shape, 0)
        if matrix is not None:
            positions = positions @ matrix.T
        with warnings.catch_warnings():  # of corners that might be joined
            warnings.simplefilter("ignore", spectral_tv.MeshWarning)
            self._mesh = spectral_tv.Mesh(positions, self._triangles[seen])
        self._shape = shape

    def _found(self, moved: np.ndarray, stretch: float) -> Counts:
        if not self._is_there.all():
            moved = np.where(self._is_there[:, np.newaxis], moved, 0)
        if self._matrix is not None:
            moved = moved @ self._matrix.T
        found = spectral_tv.folds(self._mesh, moved, stretch)
        folded, stretched = (self._faces[each] for each in (found.flipped, found.stretched))
        return Counts(len(np.unique(folded)), len(np.unique(stretched)))


def distortion(obj: bpy.types.Object) -> np.ndarray | None:
    """The rotation and scale of an object, (3, 3), if it is scaled unevenly; None else.

    An object that is flat by its scale is looked at as if it had none.
    """
    matrix = np.array(obj.matrix_world.to_3x3(), dtype=np.float64)
    lengths = np.linalg.svd(matrix, compute_uv=False)
    is_even = lengths[0] - lengths[2] <= ROUNDING * lengths[0]
    return None if is_even or np.linalg.matrix_rank(matrix) < 3 else matrix
