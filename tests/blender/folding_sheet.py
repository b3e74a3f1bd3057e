"""A sheet whose bands fold its faces, and what tests ask of it."""

from __future__ import annotations

from importlib import import_module

import bpy
import numpy as np
import pytest
from ball import object_of
from reference_guard import lengths, normals
from shapes import grid

EXTENSION = "bl_ext.user_default.spectral_tv.bands"
live_guard = import_module(f"{EXTENSION}.live_guard")
STRETCH = import_module(f"{EXTENSION}.guard").STRETCH
SCALES = {"use_scales": True, "finest": 2, "largest": 30, "keep_limbs": 0, "soft_edges": 0}
# So much of these bands folds and stretches faces.
WILD = {"Shape Detail Band 2": 3.0, "Shape Detail Band 3": 3.0}


def sheet_with_bumps(name: str = "Sheet") -> bpy.types.Object:
    """A sheet with a bump on a bump, the active object."""
    vertices, faces = grid(31, 31, 2, 2)
    x, y = vertices[:, 0] - 1, vertices[:, 1] - 1
    vertices[:, 2] = 0.3 * np.exp(-4 * (x**2 + y**2)) + 0.1 * np.exp(-60 * (x**2 + y**2))
    obj = object_of(name, vertices, faces)
    obj.select_set(True)
    return obj


def banded(obj: bpy.types.Object) -> bpy.types.Object:
    bpy.ops.spectral_tv.decompose(bands=3, steps=12, **SCALES)
    return obj


def turn(obj: bpy.types.Object, **values: float) -> None:
    """Set sliders: wild ones where none is named."""
    for name, value in (values or WILD).items():
        key(obj, name).slider_min, key(obj, name).slider_max = -10, 10
        key(obj, name).value = value
    bpy.context.view_layer.update()


def key(obj: bpy.types.Object, name: str) -> bpy.types.ShapeKey:
    return obj.data.shape_keys.key_blocks[name]


def points(of: bpy.types.ShapeKey) -> np.ndarray:
    return np.array([point.co for point in of.data], dtype=np.float64)


def triangles(obj: bpy.types.Object) -> np.ndarray:
    obj.data.calc_loop_triangles()
    return np.array([triangle.vertices for triangle in obj.data.loop_triangles])


def moved(obj: bpy.types.Object, name: str) -> np.ndarray:
    return points(key(obj, name)) - points(obj.data.shape_keys.reference_key)


def counted(obj: bpy.types.Object, displacement: np.ndarray, shape=None) -> tuple[int, int]:
    """How many faces turn by over 90°, and how many have an edge that is too long."""
    shape = points(obj.data.shape_keys.reference_key) if shape is None else shape
    faces = triangles(obj)
    turned = (normals(shape, faces) * normals(shape + displacement, faces)).sum(axis=1) < 0
    stretched = lengths(shape + displacement, faces) > STRETCH * lengths(shape, faces)
    return np.count_nonzero(turned), np.count_nonzero(stretched.any(axis=1))


def text(folded: int, stretched: int) -> str:
    return f"{folded} faces fold, {stretched} stretch"


def line() -> str:
    """What the panel says under the sliders."""
    return live_guard.line(bpy.context).text


@pytest.fixture
def sheet():
    yield banded(sheet_with_bumps())
    live_guard.forget()
