"""Objects of vertices and faces, and a small one where the shape does not matter."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
from numpy.typing import ArrayLike
from shapes import bumpy_sphere, icosphere


def object_of(name: str, vertices: ArrayLike, faces: ArrayLike) -> bpy.types.Object:
    """A mesh object in the scene, the active one."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(np.asarray(vertices).tolist(), [], np.asarray(faces).tolist())
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    return obj


def ball(name: str, detail: int = 2) -> bpy.types.Object:
    """A selected ball with the vertex group Cap, the active object."""
    vertices, faces = icosphere(detail)
    obj = object_of(name, vertices * [1, 1.2, 1.5], faces)
    cap = np.flatnonzero(vertices[:, 2] > 0.5).tolist()
    obj.vertex_groups.new(name="Cap").add(cap, 1, "REPLACE")
    obj.select_set(True)
    return obj


def bumpy_ball() -> bpy.types.Object:
    """A ball with bumps and the vertex group Cap, the active object."""
    vertices, faces = bumpy_sphere(3, amplitude=0.3)
    obj = object_of("Ball", vertices, faces)
    obj.vertex_groups.new(name="Cap").add(np.flatnonzero(vertices[:, 2] > 0.5).tolist(), 1, "ADD")
    return obj


def saved_and_loaded(obj: bpy.types.Object, path: Path) -> bpy.types.Object:
    """The object as a file has it that it was saved to."""
    bpy.data.libraries.write(str(path), {obj})
    name = obj.name
    bpy.data.batch_remove([obj])
    with bpy.data.libraries.load(str(path)) as (_, target):
        target.objects = [name]
    return target.objects[0]
