"""Files for the tests of the command line, and what is in them."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

QUICK = ["--bands", "3", "--steps", "8"]

_package = "bl_ext.user_default.spectral_tv.command_line"
run = import_module(_package).run
exportable = import_module(f"{_package}.formats").exportable
load = import_module(f"{_package}.load").load


def empty() -> None:
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.context.scene.cycles.use_denoising = False


def write_monkey(path: Path) -> Path:
    """Write a subdivided and roughened Suzanne in the format of the path's suffix."""
    empty()
    bpy.ops.mesh.primitive_monkey_add()
    modifier = bpy.context.object.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = 2
    bpy.ops.object.modifier_apply(modifier=modifier.name)
    vertices = bpy.context.object.data.vertices
    noise = np.random.default_rng(1).normal(0, 0.01, (len(vertices), 3))
    for vertex, offset in zip(vertices, noise, strict=True):
        vertex.co += Vector(offset)
    return write_scene(path)


def write_scene(path: Path) -> Path:
    """Write all that there is, in the format of the path's suffix."""
    path.parent.mkdir(exist_ok=True)
    if path.suffix == ".blend":
        bpy.data.libraries.write(str(path), {bpy.context.scene})
        return path
    module, operator, options = {
        ".ply": (bpy.ops.wm, "ply_export", {}),
        ".obj": (bpy.ops.wm, "obj_export", {}),
        ".stl": (bpy.ops.wm, "stl_export", {}),
        ".usdc": (bpy.ops.wm, "usd_export", {}),
        ".abc": (bpy.ops.wm, "alembic_export", {"end": 1}),
        ".dae": (bpy.ops.wm, "collada_export", {}),
        ".glb": (bpy.ops.export_scene, "gltf", {}),
        ".gltf": (bpy.ops.export_scene, "gltf", {"export_format": "GLTF_SEPARATE"}),
        ".fbx": (bpy.ops.export_scene, "fbx", {}),
    }[path.suffix]
    getattr(module, operator)(filepath=str(path), **options)
    return path


def decompose(source: Path, target: Path, *options: str) -> int:
    """The exit code of a quick decomposition of one file."""
    return run(["decompose", str(source), "-o", str(target), *QUICK, *options])


def meshes() -> list[bpy.types.Object]:
    return [obj for obj in bpy.context.scene.objects if obj.type == "MESH"]


def band_values(obj) -> list[float]:
    return [key.value for key in obj.data.shape_keys.key_blocks if "Band" in key.name]
