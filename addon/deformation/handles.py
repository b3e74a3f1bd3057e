"""The constraints of an object as the arrays of a deformation."""

from dataclasses import dataclass

import bpy
import numpy as np

from ..scene.objects import Refusal
from ..scene.records import coordinates
from ..scene.surface import basis_coordinates
from .constraints import SpectralTVConstraint, deformation_of

# Painted weights reach 1 and 0 but for rounding.
EXACT, NOTHING = 0.999, 1e-3


@dataclass(frozen=True)
class Handles:
    """Constrained vertices: ``indices`` (K,) in the object, ``weights`` (K,) in (0, 1].

    ``owners`` (K,) tells whose constraint each is, ``positions`` (K, 3) where it is in Basis.
    """

    indices: np.ndarray
    weights: np.ndarray
    owners: np.ndarray
    positions: np.ndarray

    @classmethod
    def read(cls, obj: bpy.types.Object) -> "Handles":
        """Read the vertex groups of the constraints of ``obj``.

        Raises Refusal if there are none, or a group is missing or empty.
        """
        constraints = deformation_of(obj).constraints
        if not constraints:
            raise Refusal("it has no constraints; pin a vertex group and add a handle")
        groups = [_group_index(obj, constraint) for constraint in constraints]
        weights = group_weights(obj, set(groups))
        indices, owners, values = [], [], []
        for owner, (constraint, group) in enumerate(zip(constraints, groups, strict=True)):
            found, weight = weights[group]
            if not len(found):
                raise Refusal(f"the vertex group {constraint.vertex_group!r} is empty")
            indices.append(found)
            values.append(weight)
            owners.append(np.full(len(found), owner))
        every = np.concatenate(indices)
        basis = basis_coordinates(obj.data)
        return cls(every, np.concatenate(values), np.concatenate(owners), basis[every])

    def targets(self, obj: bpy.types.Object) -> np.ndarray:
        """Where the constraints of ``obj`` take the vertices now, in object space, (K, 3).

        Raises Refusal if what they follow is missing, or two send a vertex to different places.
        """
        constraints = deformation_of(obj).constraints
        targets = self.positions.copy()
        for owner, constraint in enumerate(constraints):
            mine = self.owners == owner
            if constraint.kind == "OBJECT":
                motion = np.array(constraint.motion(), dtype=np.float64)
                targets[mine] = self.positions[mine] @ motion[:3, :3].T + motion[:3, 3]
            elif constraint.kind == "KEY":
                targets[mine] = _key_positions(obj, constraint)[self.indices[mine]]
        self._check_overlaps(targets, constraints)
        return targets

    def _check_overlaps(self, targets: np.ndarray, constraints) -> None:
        exact = np.flatnonzero(self.weights == 1)
        vertices, first, inverse = np.unique(
            self.indices[exact], return_index=True, return_inverse=True
        )
        if len(vertices) == len(exact):
            return
        other = exact[first][inverse.ravel()]
        scale = np.ptp(self.positions, axis=0).max()
        apart = np.abs(targets[exact] - targets[other]).max(axis=1) > 1e-6 * scale
        if apart.any():
            entry = int(np.argmax(apart))
            one, two = (
                constraints[self.owners[index]].vertex_group
                for index in (other[entry], exact[entry])
            )
            raise Refusal(
                f"{np.count_nonzero(apart)} vertices, such as {self.indices[exact[entry]]}, are in "
                f"both {one!r} and {two!r}, which go to different places"
            )


def group_weights(
    obj: bpy.types.Object, groups: set[int]
) -> dict[int, tuple[np.ndarray, np.ndarray]]:
    """Vertices and weights of vertex groups, by the groups' indices."""
    found: dict[int, tuple[list[int], list[float]]] = {group: ([], []) for group in groups}
    for vertex in obj.data.vertices:
        for membership in vertex.groups:
            if membership.group in found and membership.weight > NOTHING:
                vertices, weights = found[membership.group]
                vertices.append(vertex.index)
                weights.append(membership.weight)
    return {
        group: (np.array(vertices, dtype=np.int64), _rounded(np.array(weights)))
        for group, (vertices, weights) in found.items()
    }


def _rounded(weights: np.ndarray) -> np.ndarray:
    return np.where(weights >= EXACT, 1.0, weights)


def _group_index(obj: bpy.types.Object, constraint: SpectralTVConstraint) -> int:
    if not constraint.vertex_group:
        raise Refusal("a constraint has no vertex group")
    index = obj.vertex_groups.find(constraint.vertex_group)
    if index < 0:
        raise Refusal(f"there is no vertex group {constraint.vertex_group!r}")
    return index


def _key_positions(obj: bpy.types.Object, constraint: SpectralTVConstraint) -> np.ndarray:
    keys = obj.data.shape_keys
    if keys is None or constraint.shape_key not in keys.key_blocks:
        raise Refusal(f"there is no shape key {constraint.shape_key!r} to move to")
    return coordinates(keys.key_blocks[constraint.shape_key].data).reshape(-1, 3).astype(float)
