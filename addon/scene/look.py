"""Making a part of the mix of shape keys the shape itself."""

from collections.abc import Sequence

import bpy
import numpy as np

from .coordinates import coordinates
from .shape_keys import remove_key


def become(
    obj: bpy.types.Object, displacement: np.ndarray, spent: Sequence[bpy.types.ShapeKey]
) -> None:
    """Move the mesh and all its shape keys by (V, 3), in object space, and remove those ``spent``.

    The other keys move the vertices as before. If only Basis is left, it goes too, as Blender does
    more with a mesh that has no shape keys.
    """
    mesh = obj.data
    for key in mesh.shape_keys.key_blocks:
        _move(key.points, displacement)
    _move(mesh.vertices, displacement)
    names = [key.name for key in spent]  # removing one gives the others another place in memory
    for name in names:
        remove_key(obj, mesh.shape_keys.key_blocks[name])
    if len(mesh.shape_keys.key_blocks) == 1:
        obj.shape_key_clear()
    mesh.update()


def _move(points: bpy.types.bpy_prop_collection, displacement: np.ndarray) -> None:
    moved = coordinates(points) + displacement.astype(np.float32).ravel()
    points.foreach_set("co", moved.astype(np.float32))
