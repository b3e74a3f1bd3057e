"""Blender with the extension that ``make extension`` built: in pip's ``bpy``, or in the program."""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

if "bpy" not in sys.modules:
    _RESOURCES = tempfile.TemporaryDirectory(prefix="spectral_tv_bench_")
    os.environ["BLENDER_USER_RESOURCES"] = _RESOURCES.name  # bpy reads it on import

import bpy
import numpy as np

MODULE = "bl_ext.user_default.spectral_tv"
DIST = Path(__file__).resolve().parents[2] / "dist"


def install() -> None:
    """Have an empty file, and the extension enabled."""
    (built,) = DIST.glob("spectral_tv-*.zip")
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.extensions.package_install_files(
        filepath=str(built), repo="user_default", enable_on_install=True
    )


def add_object(vertices: np.ndarray, triangles: np.ndarray) -> bpy.types.Object:
    """An object with a mesh, the active one."""
    mesh = bpy.data.meshes.new("Mesh")
    mesh.from_pydata(vertices.tolist(), [], triangles.tolist())
    obj = bpy.data.objects.new("Mesh", mesh)
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    return obj
