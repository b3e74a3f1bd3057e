"""Fields of Blender's collections as arrays."""

from __future__ import annotations

import bpy
from spectral_tv.later import np


def numbers(
    items: bpy.types.bpy_prop_collection, field: str, width: int = 1, dtype: str | type = "int32"
) -> np.ndarray:
    """A field of all items, flat: ``width`` numbers of each."""
    flat = np.empty(width * len(items), dtype=dtype)
    items.foreach_get(field, flat)
    return flat


def corner_vertices(mesh: bpy.types.Mesh) -> np.ndarray:
    """The vertex of every face corner."""
    return numbers(mesh.loops, "vertex_index")


def polygon_starts(mesh: bpy.types.Mesh) -> np.ndarray:
    """The first corner of every polygon."""
    return numbers(mesh.polygons, "loop_start")
