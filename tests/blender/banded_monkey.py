"""Suzanne with four bands, and what tests read of shape keys."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

EXTENSION = "bl_ext.user_default.spectral_tv"


def values(obj) -> list[float]:
    blocks = obj.data.shape_keys.key_blocks
    return [key.value for key in blocks if "Band" in key.name]


def shape(key) -> np.ndarray:
    flat = np.empty(3 * len(key.data), dtype=np.float32)
    key.data.foreach_get("co", flat)
    return flat


def activate(obj) -> None:
    for other in bpy.context.selected_objects:
        other.select_set(False)
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)


@pytest.fixture
def banded(monkey):
    bpy.ops.spectral_tv.decompose(bands=4, steps=12)
    return monkey
