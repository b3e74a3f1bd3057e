"""Weights of vertex groups as arrays."""

from __future__ import annotations

from collections.abc import Iterable

import bpy
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

# Weights below that are taken out of a vertex group.
NOTHING = 1e-6


def group_named(obj: bpy.types.Object, name: str) -> bpy.types.VertexGroup:
    """The vertex group of this name; raises Refusal if there is none."""
    if name not in obj.vertex_groups:
        raise Refusal(f"there is no vertex group {name!r}")
    return obj.vertex_groups[name]


def members(
    obj: bpy.types.Object, names: Iterable[str]
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """The vertices in vertex groups and their weights, by the groups' names."""
    groups = {obj.vertex_groups[name].index: name for name in names}
    found: dict[str, tuple[list[int], list[float]]] = {name: ([], []) for name in groups.values()}
    for vertex in obj.data.vertices:
        for membership in vertex.groups:
            name = groups.get(membership.group)
            if name is not None:
                found[name][0].append(vertex.index)
                found[name][1].append(membership.weight)
    return {
        name: (np.array(vertices, dtype=np.int32), np.array(values, dtype=np.float32))
        for name, (vertices, values) in found.items()
    }


def weights_of(obj: bpy.types.Object, group: bpy.types.VertexGroup) -> np.ndarray:
    """The weight of every vertex in a group, (V,); 0 outside."""
    vertices, found = members(obj, [group.name])[group.name]
    weights = np.zeros(len(obj.data.vertices))
    weights[vertices] = found
    return weights


def add_group(obj: bpy.types.Object, name: str) -> bpy.types.VertexGroup:
    """A new vertex group, so far empty; the active one stays it."""
    active = obj.vertex_groups.active_index
    group = obj.vertex_groups.new(name=name)
    if active >= 0:
        obj.vertex_groups.active_index = active
    return group


def set_weights(group: bpy.types.VertexGroup, weights: np.ndarray) -> None:
    """Give all vertices their weights in a group, (V,), cut off at 0 and 1; 0 is outside."""
    weights = np.clip(weights, 0, 1).astype(np.float32)
    group.remove(np.flatnonzero(weights <= NOTHING).tolist())
    inside = np.flatnonzero(weights > NOTHING)
    values, counts = np.unique(weights[inside], return_counts=True)
    alike = np.split(inside[np.argsort(weights[inside], kind="stable")], np.cumsum(counts)[:-1])
    for value, vertices in zip(values.tolist(), alike, strict=False):
        group.add(vertices.tolist(), value, "REPLACE")
