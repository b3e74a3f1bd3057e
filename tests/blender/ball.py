"""A small object for tests in which the shape does not matter."""

from __future__ import annotations

import bpy
import numpy as np
from shapes import icosphere


def ball(name: str, detail: int = 2) -> bpy.types.Object:
    """A selected ball with the vertex group Cap, the active object."""
    vertices, faces = icosphere(detail)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata((vertices * [1, 1.2, 1.5]).tolist(), [], faces.tolist())
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    cap = np.flatnonzero(vertices[:, 2] > 0.5).tolist()
    obj.vertex_groups.new(name="Cap").add(cap, 1, "REPLACE")
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    return obj
