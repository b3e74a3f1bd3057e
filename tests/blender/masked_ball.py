"""Masks of a ball with three bands, and what tests ask of them."""

from __future__ import annotations

import bmesh
import bpy
import numpy as np
from deform_scene import coordinates

SMALL = {"bands": 3, "steps": 8}
BANDS = [f"Shape Detail Band {band}" for band in (1, 2, 3)]
MASKS = [f"{name} Mask" for name in BANDS]


def keys(obj):
    return obj.data.shape_keys.key_blocks


def weights(obj, name: str) -> np.ndarray:
    """Those of a vertex group, 0 outside."""
    index = obj.vertex_groups[name].index
    found = [[each.weight for each in v.groups if each.group == index] for v in obj.data.vertices]
    return np.array([sum(each) for each in found])


def mask(obj, band: int = 2) -> np.ndarray:
    return weights(obj, keys(obj)[BANDS[band - 1]].vertex_group)


def paint(obj, name: str, vertices, weight: float = 0.0) -> None:
    """What a brush does to a vertex group."""
    obj.vertex_groups[name].add([int(each) for each in vertices], weight, "REPLACE")
    obj.data.update_tag()


def select(obj, is_selected: np.ndarray) -> None:
    """Select vertices of the active object alone."""
    bpy.ops.object.mode_set(mode="EDIT")
    edited = bmesh.from_edit_mesh(obj.data)
    edited.select_mode = {"VERT"}
    for vertex, selected in zip(edited.verts, is_selected, strict=True):
        vertex.select_set(bool(selected))
    edited.select_flush_mode()
    bpy.ops.object.mode_set(mode="OBJECT")


def heights(obj) -> np.ndarray:
    return coordinates(obj.data.vertices)[:, 2]


def own(obj) -> list[str]:
    """The vertex groups that are known as masks that were made."""
    return obj.data.spectral_tv.masks.keys()
