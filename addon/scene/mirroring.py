"""The other half that Mirror modifiers show, as copies of a mesh in object space."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np

# Reflections of the axes x, y and z.
FLIPS = ((-1.0, 1.0, 1.0), (1.0, -1.0, 1.0), (1.0, 1.0, -1.0))


@dataclass(frozen=True)
class Copies:
    """C copies of V vertices, of which the first is the mesh itself.

    ``turns`` (C, 3, 3) takes directions of the mesh to those of each copy; ``positions``
    (N, 3) are those of all copies, where ``places`` (C, V) tells which is which: a vertex that a
    modifier merges with its mirror image is one, half-way between them. ``is_flipped`` (C,)
    tells whose faces look inside out.
    """

    turns: np.ndarray
    positions: np.ndarray
    places: np.ndarray
    is_flipped: np.ndarray

    def turned(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors of the mesh's vertices (V, 3) as those of each copy, (C, V, 3)."""
        return np.stack([vectors @ turn.T for turn in self.turns])


def single(shape: np.ndarray) -> Copies:
    """A shape (V, 3) that is mirrored nowhere."""
    whole = np.arange(len(shape))[np.newaxis]
    return Copies(np.eye(3)[np.newaxis], shape, whole, np.zeros(1, dtype=bool))


def mirrored(
    obj: bpy.types.Object, shape: np.ndarray, modifiers: Sequence[bpy.types.MirrorModifier]
) -> Copies:
    """The copies of a shape (V, 3) of ``obj`` that its Mirror modifiers show."""
    copies = single(shape.copy())
    turns, positions, places = copies.turns, copies.positions, copies.places
    flipped = copies.is_flipped
    for modifier in modifiers:
        to_plane = _space(obj, modifier)
        for axis in np.flatnonzero(modifier.use_axis):
            reflection = _affine(to_plane, FLIPS[axis])
            images = positions @ reflection[:3, :3].T + reflection[:3, 3]
            turns = np.concatenate([turns, reflection[:3, :3] @ turns])
            flipped = np.concatenate([flipped, ~flipped])
            merged = np.zeros(len(positions), dtype=bool)
            if modifier.use_mirror_merge:
                away = np.linalg.norm(images - positions, axis=1)
                merged = away <= modifier.merge_threshold
            middle = (positions[merged] + images[merged]) / 2
            number = np.where(merged, np.arange(len(positions)), 0)
            number[~merged] = len(positions) + np.arange(np.count_nonzero(~merged))
            positions = np.concatenate([positions, images[~merged]])
            positions[np.flatnonzero(merged)] = middle
            places = np.concatenate([places, number[places]])
    return Copies(turns, positions, places, flipped)


def _space(obj: bpy.types.Object, modifier: bpy.types.MirrorModifier) -> np.ndarray:
    """From object space to the space whose planes are mirrors, (4, 4)."""
    if modifier.mirror_object is None:
        return np.eye(4)
    matrix = modifier.mirror_object.matrix_world.inverted_safe() @ obj.matrix_world
    return np.array(matrix, dtype=np.float64)


def _affine(to_plane: np.ndarray, flip: tuple[float, ...]) -> np.ndarray:
    """The reflection in object space, (4, 4)."""
    return np.linalg.inv(to_plane) @ np.diag([*flip, 1.0]) @ to_plane
