"""Bringing a mesh file into Blender as one object that stands upright."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

from .studio import vertices_of

# Scans and sculpts that say nothing of axes mostly have Y up; Z only if they clearly stand on it.
CLEARLY = 1.5
SLAB = 0.01


def import_mesh(path: Path, up: str | None = None) -> bpy.types.Object:
    """Import a file and return its largest mesh as the only object.

    Parameters
    ----------
    path : Path
        .ply, .stl, .obj, .glb, .gltf, .fbx, .usd*, .abc or .blend.
    up : {"Y", "Z"}, optional
        The axis of a .ply or .stl file that points up; guessed where it is not given. Other
        formats know.

    Returns
    -------
    bpy.types.Object
        Its rotation applied, so that object space is upright too.
    """
    importer = IMPORTERS.get(path.suffix.lower())
    if importer is None:
        sys.exit(f"{path}: cannot import {path.suffix!r}; known are {' '.join(IMPORTERS)}")
    if not path.is_file():
        sys.exit(f"{path}: no such file")
    importer(str(path))
    meshes = [obj for obj in bpy.context.scene.objects if obj.type == "MESH"]
    if not meshes:
        sys.exit(f"{path}: there is no mesh in it")
    obj = max(meshes, key=lambda candidate: len(candidate.data.vertices))
    placement = obj.matrix_world.copy()
    has_axes = path.suffix.lower() not in (".ply", ".stl")
    if not has_axes and (up or guess_up(vertices_of(obj.data))) == "Y":
        placement = Matrix.Rotation(math.pi / 2, 4, "X") @ placement
    obj.data.transform(placement)
    obj.matrix_world = Matrix.Identity(4)
    for other in list(bpy.data.objects):
        if other is not obj:
            bpy.data.objects.remove(other)
    bpy.context.view_layer.objects.active = obj
    return obj


def guess_up(vertices: np.ndarray) -> str:
    """Guess which axis of (V, 3) positions points up: "Y" or "Z"."""
    height = np.ptp(vertices, axis=0)
    standing = (vertices - vertices.min(axis=0) < SLAB * height).mean(axis=0)
    return "Z" if standing[2] > CLEARLY * standing[1] else "Y"


def _append(path: str) -> None:
    with bpy.data.libraries.load(path) as (source, target):
        target.objects = source.objects
    for obj in target.objects:
        bpy.context.scene.collection.objects.link(obj)


def _operator(module: str, name: str):
    def run(path: str) -> None:
        getattr(getattr(bpy.ops, module), name)(filepath=path)

    return run


IMPORTERS = {
    ".ply": _operator("wm", "ply_import"),
    ".stl": _operator("wm", "stl_import"),
    ".obj": _operator("wm", "obj_import"),
    ".glb": _operator("import_scene", "gltf"),
    ".gltf": _operator("import_scene", "gltf"),
    ".fbx": _operator("import_scene", "fbx"),
    ".usd": _operator("wm", "usd_import"),
    ".usda": _operator("wm", "usd_import"),
    ".usdc": _operator("wm", "usd_import"),
    ".abc": _operator("wm", "alembic_import"),
    ".blend": _append,
}
