"""Fields of Blender's collections as arrays."""

import bpy
import numpy as np


def numbers(
    items: bpy.types.bpy_prop_collection, field: str, width: int = 1, dtype: type = np.int32
) -> np.ndarray:
    """A field of all items, flat: ``width`` numbers of each."""
    flat = np.empty(width * len(items), dtype=dtype)
    items.foreach_get(field, flat)
    return flat


def means(
    places: np.ndarray, values: np.ndarray, count: int, weights: np.ndarray | None = None
) -> np.ndarray:
    """The means (count, C) of values (N, C), each at one of the places (N,); 0 where none is.

    ``weights`` (N,) are equal if not given.
    """
    weights = np.ones(len(places)) if weights is None else weights
    total = np.bincount(places, weights, count)
    sums = [np.bincount(places, weights * channel, count) for channel in values.T]
    return np.column_stack(sums) / np.where(total > 0, total, 1)[:, np.newaxis]


def corner_vertices(mesh: bpy.types.Mesh) -> np.ndarray:
    """The vertex of every face corner."""
    return numbers(mesh.loops, "vertex_index")


def polygon_starts(mesh: bpy.types.Mesh) -> np.ndarray:
    """The first corner of every polygon."""
    return numbers(mesh.polygons, "loop_start")
