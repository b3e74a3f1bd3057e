"""Constraints of vertex groups, and empties to move them by."""

import bpy
from mathutils import Matrix, Vector
from spectral_tv.later import np

from ..scene.coordinates import basis_coordinates
from . import constraints
from .handles import group_weights


def constrain(obj: bpy.types.Object, group: str, kind: str) -> constraints.SpectralTVConstraint:
    """Add a constraint of a vertex group; a handle gets an empty."""
    constraint = constraints.add(obj, group, kind)
    if kind == "OBJECT":
        constraint.target = add_empty(obj, group)
    return constraint


def add_empty(obj: bpy.types.Object, group: str) -> bpy.types.Object:
    """Add an empty in the middle of a vertex group, or at the object if that is empty."""
    obj.update_from_editmode()
    members, _ = group_weights(obj, [group])[group]
    empty = bpy.data.objects.new(f"{obj.name} {group}", None)
    empty.empty_display_type = "ARROWS"
    empty.empty_display_size = max(max(obj.dimensions) / 6, 1e-3)
    for collection in obj.users_collection or [bpy.context.scene.collection]:
        collection.objects.link(empty)
    middle = np.zeros(3)
    if len(members):
        middle = basis_coordinates(obj.data)[members].mean(axis=0)
    # The matrix, as hidden objects' locations are not evaluated.
    empty.matrix_world = Matrix.Translation(obj.matrix_world @ Vector(middle))
    bpy.context.view_layer.update()
    return empty
