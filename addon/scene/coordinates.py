"""Positions and triangles of a mesh as arrays."""

from __future__ import annotations

import bpy
from spectral_tv.later import np

from .arrays import corner_vertices, numbers, polygon_starts
from .temporary import Temporary


def coordinates(data: bpy.types.bpy_prop_collection) -> np.ndarray:
    """Flat float32 coordinates of vertices or shape key points."""
    return numbers(data, "co", 3, dtype=np.float32)


def points(data: bpy.types.bpy_prop_collection) -> np.ndarray:
    """Coordinates of vertices or shape key points in double precision, (V, 3)."""
    return coordinates(data).reshape(-1, 3).astype(np.float64)


def seen_coordinates(obj: bpy.types.Object) -> np.ndarray:
    """Where the vertices of an object are seen, its keys and modifiers applied, in object space,
    (V, 3).
    """
    bpy.context.view_layer.update()
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return points(evaluated.data.vertices)


def basis_coordinates(mesh: bpy.types.Mesh) -> np.ndarray:
    """Positions of the Basis shape key, or of the mesh where it has none, (V, 3)."""
    keys = mesh.shape_keys
    return points(mesh.vertices if keys is None else keys.reference_key.points)


def triangles(mesh: bpy.types.Mesh, shape: np.ndarray | None = None) -> np.ndarray:
    """Vertices of the triangles that Blender draws of the mesh's polygons, (F, 3).

    In a ``shape`` (V, 3) of its own a polygon may be cut another way.
    """
    if shape is not None and len(mesh.loops) > 3 * len(mesh.polygons):
        with Temporary() as now:
            return triangles(now.made(_bent(mesh, shape)))
    mesh.calc_loop_triangles()
    corners = numbers(mesh.loop_triangles, "vertices", 3)
    return corners.reshape(-1, 3)


def _bent(mesh: bpy.types.Mesh, shape: np.ndarray) -> bpy.types.Mesh:
    """A new mesh with the polygons of another, and vertices (V, 3)."""
    bent = bpy.data.meshes.new(mesh.name)
    bent.vertices.add(len(mesh.vertices))
    bent.loops.add(len(mesh.loops))
    bent.polygons.add(len(mesh.polygons))
    bent.vertices.foreach_set("co", shape.astype(np.float32).ravel())
    corners = corner_vertices(mesh)
    starts = polygon_starts(mesh)
    bent.loops.foreach_set("vertex_index", corners)
    bent.polygons.foreach_set("loop_start", starts)
    return bent
