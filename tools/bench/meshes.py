"""Meshes to measure on: generated, or read from a file."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np


def bumpy_sphere(subdivisions: int) -> tuple[np.ndarray, np.ndarray]:
    """An icosphere with detail: vertices (V, 3) and triangles (F, 3)."""
    vertices, triangles = sphere(subdivisions)
    waves = sum(np.sin(k * vertices[:, axis]) / k for axis in range(3) for k in (5, 11, 23))
    return vertices * (1 + 0.1 * waves)[:, None], triangles


def sphere(subdivisions: int) -> tuple[np.ndarray, np.ndarray]:
    """Blender's icosphere of radius 1: vertices (V, 3) and triangles (F, 3)."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=subdivisions + 1)
    return arrays(bpy.context.object.data)


def pinched_sphere(subdivisions: int) -> tuple[np.ndarray, np.ndarray]:
    """Two bumpy halves with a neck between them: vertices (V, 3) and triangles (F, 3)."""
    vertices, triangles = bumpy_sphere(subdivisions)
    waist = 1 - 0.7 * np.exp(-((vertices[:, 2:] / 0.3) ** 2))
    return vertices * np.hstack([waist, waist, np.full_like(waist, 1.5)]), triangles


def read_ply(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """The first mesh of a .ply file: vertices (V, 3) and triangles (F, 3)."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.ply_import(filepath=str(path))
    return arrays(bpy.context.object.data)


def arrays(mesh: bpy.types.Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V, 3) and triangles (F, 3) of a mesh."""
    mesh.calc_loop_triangles()
    vertices = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    triangles = np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
    mesh.vertices.foreach_get("co", vertices)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    return vertices.reshape(-1, 3).astype(float), triangles.reshape(-1, 3)
