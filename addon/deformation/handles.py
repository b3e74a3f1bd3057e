"""The constraints of an object as the arrays of a deformation."""

from __future__ import annotations

from collections.abc import Collection
from functools import cached_property

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.deformation.held import constraining, note_soft_pin
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

from ..scene.coordinates import basis_coordinates
from ..scene.shape_keys import key_shape
from ..scene.weights import group_named, members
from .constraints import identified


@dataclass(frozen=True)
class Handles:
    """Constrained vertices: ``indices`` (K,) in the object, ``weights`` (K,) in (0, 1].

    ``owners`` (K,) are the identifiers of their constraints, ``positions`` (K, 3) where they are
    in Basis.
    """

    indices: np.ndarray
    weights: np.ndarray
    owners: np.ndarray
    positions: np.ndarray

    @classmethod
    def read(cls, obj: bpy.types.Object) -> Handles:
        """Read the vertex groups of the constraints of ``obj``.

        Raises Refusal if there are none, or a group is missing or empty.
        """
        constraints = identified(obj)
        if not constraints:
            raise Refusal("it has no constraints; pin a vertex group and add a handle")
        for constraint in constraints.values():
            if not constraint.vertex_group:
                raise Refusal("a constraint has no vertex group")
            group_named(obj, constraint.vertex_group)
        weights = group_weights(obj, {each.vertex_group for each in constraints.values()})
        indices, owners, values = [], [], []
        for owner, constraint in constraints.items():
            found, weight = weights[constraint.vertex_group]
            if not len(found):
                raise Refusal(f"the vertex group {constraint.vertex_group!r} is empty")
            if constraint.kind == "PIN":
                note_soft_pin(constraint.vertex_group, weight)
            indices.append(found)
            values.append(weight)
            owners.append(np.full(len(found), owner))
        every = np.concatenate(indices)
        basis = basis_coordinates(obj.data)
        return cls(every, np.concatenate(values), np.concatenate(owners), basis[every])

    @cached_property
    def _read(self) -> set[int]:
        """Identifiers of the constraints that were read."""
        return set(np.unique(self.owners).tolist())

    def targets(self, obj: bpy.types.Object) -> np.ndarray:
        """Where the constraints of ``obj`` take the vertices now, in object space, (K, 3).

        Raises Refusal if what they follow is missing, or a constraint was added or removed since
        they were read.
        """
        constraints = identified(obj)
        if set(constraints) != self._read:
            raise Refusal("its constraints changed")
        graph = bpy.context.evaluated_depsgraph_get()
        targets = self.positions.copy()
        for owner, constraint in constraints.items():
            mine = self.owners == owner
            if constraint.kind == "OBJECT":
                motion = constraint.motion(graph)
                targets[mine] = self.positions[mine] @ motion[:3, :3].T + motion[:3, 3]
            elif constraint.kind == "KEY":
                shape = key_shape(obj.data, constraint.shape_key, "to move to")
                targets[mine] = shape[self.indices[mine]]
        return targets


def group_weights(
    obj: bpy.types.Object, groups: Collection[str]
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Vertices of vertex groups and their weights in (0, 1], by the groups' names."""
    found = {}
    for name, (vertices, weights) in members(obj, groups).items():
        is_in, rounded = constraining(weights)
        found[name] = vertices[is_in].astype(np.int64), rounded
    return found
