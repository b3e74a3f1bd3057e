"""A rig found in a pose as bones, in the space of an armature that is not scaled."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import spectral_tv
from mathutils import Matrix, Quaternion, Vector
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np

from ..scene.surface import Surface

# Weights up to this are left out: nobody sees what they move.
NOTHING = 1e-4
# The least length of a bone, relative to the object's size: Blender removes those without any.
SHORTEST = 1e-2


@dataclass(frozen=True)
class Bone:
    """A bone at rest from ``head`` to ``tail``, and the ``motion`` (4, 4) that poses it.

    ``parent`` is its place among the bones, None for one that hangs on none. ``weights`` (V,) are
    of the object's vertices.
    """

    head: Vector
    tail: Vector
    parent: int | None
    motion: Matrix
    weights: np.ndarray

    def relative(self, bones: Sequence[Bone]) -> Matrix:
        """What it does beside what its parent does."""
        if self.parent is None:
            return self.motion
        return bones[self.parent].motion.inverted() @ self.motion


def placed(obj: bpy.types.Object) -> Matrix:
    """Where an armature for ``obj`` is in the world: at the object, turned like it, not scaled."""
    place = _rotation(obj.matrix_world.to_3x3()).to_4x4()
    place.translation = obj.matrix_world.translation
    return place


def bones_of(surface: Surface, rig: spectral_tv.Rig) -> list[Bone]:
    """The bones of a rig that was found on the surface of an object.

    Where a Mirror modifier shows another half, pieces in that alone have none.
    """
    weights = _weights(surface, rig)
    kept = _needed(rig.parents, weights)
    places = {piece: place for place, piece in enumerate(kept)}
    # The one that was read: the object may have been turned since.
    back = _rotation(Matrix(surface.matrix)).inverted()
    least = SHORTEST * float(np.linalg.norm(np.ptp(surface.mesh.vertices, axis=0)))
    bones = []
    for piece in kept:
        head, tail = (back @ Vector(points[piece]) for points in (rig.heads, rig.tails))
        if (tail - head).length < least:
            tail = head + Vector((0, 0, least))
        turn = Quaternion(rig.rotations[piece]).to_matrix()
        motion = (back @ turn @ back.inverted()).to_4x4()
        motion.translation = back @ Vector(rig.translations[piece])
        parent = places.get(int(rig.parents[piece]))
        bones.append(Bone(head, tail, parent, motion, weights[:, piece]))
    return bones


def unlikeness(surface: Surface, rig: spectral_tv.Rig, posed: np.ndarray) -> float:
    """How far bones take a vertex from where a pose (N, 3) has it, relative to the size."""
    vertices = surface.mesh.vertices
    shown = np.zeros_like(vertices)
    for piece, turn in enumerate(rig.rotations):
        matrix = np.array(Quaternion(turn).to_matrix())
        shown += rig.weights[:, [piece]] * (vertices @ matrix.T + rig.translations[piece])
    size = np.linalg.norm(np.ptp(vertices, axis=0))
    return float(np.linalg.norm(shown - posed, axis=1).max() / size)


def _rotation(matrix: Matrix) -> Matrix:
    """The rotation (3, 3) in one that may also scale, mirror and shear."""
    return matrix.to_4x4().decompose()[1].to_matrix()


def _weights(surface: Surface, rig: spectral_tv.Rig) -> np.ndarray:
    """Weights (V, P) of the object's vertices that sum to 1, but for vertices that are left out."""
    weights = surface.to_vertices(rig.weights)
    weights[weights <= NOTHING] = 0
    sums = weights.sum(axis=1, keepdims=True)
    return np.divide(weights, sums, out=weights, where=sums > 0)


def _needed(parents: np.ndarray, weights: np.ndarray) -> list[int]:
    """The pieces that move something, and those that they hang on: each after its own."""
    needed: list[int] = []
    for piece in np.flatnonzero(weights.any(axis=0)).tolist():
        line = [piece]
        while (parent := int(parents[line[-1]])) >= 0:
            line.append(parent)
        needed += [each for each in reversed(line) if each not in needed]
    return needed
