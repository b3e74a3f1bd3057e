"""Making a part of the mix of shape keys and bands the shape itself."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
from spectral_tv.later import np

from . import keeping
from .coordinates import coordinates
from .mix import keys_of


def become(obj: bpy.types.Object, displacement: np.ndarray, spent: Sequence[keeping.Band]) -> None:
    """Move the mesh and all its shape keys by (V, 3), in object space, and remove bands ``spent``.

    The other keys move the vertices as before. If only Basis is left, it goes too, as Blender does
    more with a mesh that has no shape keys.
    """
    mesh = obj.data
    for key in keys_of(mesh).values():
        _move(key.points, displacement)
    _move(mesh.vertices, displacement)
    for place in keeping.PLACES.values():
        place.remove(obj, [band for band in spent if keeping.place_of(band) == place])
    if len(keys_of(mesh)) == 1:
        obj.shape_key_clear()
    mesh.update()


def _move(points: bpy.types.bpy_prop_collection, displacement: np.ndarray) -> None:
    moved = coordinates(points) + displacement.astype(np.float32).ravel()
    points.foreach_set("co", moved.astype(np.float32))
