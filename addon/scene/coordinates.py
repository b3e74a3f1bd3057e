"""Positions and triangles of a mesh as arrays."""

import bpy
import numpy as np


def coordinates(data: bpy.types.bpy_prop_collection) -> np.ndarray:
    """Flat float32 coordinates of vertices or shape key points."""
    flat = np.empty(3 * len(data), dtype=np.float32)
    data.foreach_get("co", flat)
    return flat


def basis_coordinates(mesh: bpy.types.Mesh) -> np.ndarray:
    """Positions of the Basis shape key, or of the mesh where it has none, (V, 3)."""
    keys = mesh.shape_keys
    source = mesh.vertices if keys is None else keys.reference_key.data
    return coordinates(source).reshape(-1, 3).astype(np.float64)


def triangles(mesh: bpy.types.Mesh) -> np.ndarray:
    """Vertices of the triangles of the mesh's polygons, (F, 3)."""
    mesh.calc_loop_triangles()
    corners = np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
    mesh.loop_triangles.foreach_get("vertices", corners)
    return corners.reshape(-1, 3)
