"""Reading the shapes of a mesh."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import spectral_tv

# What the bands of methods are called after.
LABELS = {"M1": "Shape Detail", "M2": "Limbs and Head", "M3": "Edge-Keeping Detail"}


def opened(blend: Path) -> tuple[bpy.types.Object, np.ndarray, spectral_tv.Mesh]:
    """The mesh object in a file, its vertices without shape keys, (V, 3), and its surface."""
    bpy.ops.wm.open_mainfile(filepath=str(blend.resolve()))
    obj = next(obj for obj in bpy.data.objects if obj.type == "MESH")
    basis = coordinates(obj, "Basis")
    obj.data.calc_loop_triangles()
    triangles = [list(each.vertices) for each in obj.data.loop_triangles]
    return obj, basis, spectral_tv.Mesh(basis, triangles)


def band(obj: bpy.types.Object, method: str, number: int) -> np.ndarray:
    """The shape with a band of a method doubled, (V, 3); bands count from 1, the finest."""
    return coordinates(obj, f"{LABELS[method]} Band {number}")


def coordinates(obj: bpy.types.Object, key: str) -> np.ndarray:
    """Positions of a shape key, (V, 3)."""
    data = obj.data.shape_keys.key_blocks[key].data
    flat = np.empty(3 * len(data), dtype=np.float32)
    data.foreach_get("co", flat)
    return flat.reshape(-1, 3).astype(np.float64)
