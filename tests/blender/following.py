"""Whether meshes follow the bands of a body on all frames."""

from __future__ import annotations

from importlib import import_module

import bpy
import numpy as np
from conftest import MODULE
from deform_scene import evaluated
from mathutils.kdtree import KDTree
from rigged_body import FRAMES

all_bands = import_module(f"{MODULE}.scene.records").all_bands_of


def assert_follow(others: list[bpy.types.Object], obj: bpy.types.Object) -> None:
    """The bands move the others on each frame about as they move the nearest vertices of the body,
    which are coarse."""
    obj.modifiers["Subdivision"].show_viewport = False  # which smooths what bands do
    every = [obj, *others]
    there = _everywhere(every)
    dialled = [(band, band.value) for each in every for band in all_bands(each)]
    for band, _ in dialled:
        band.value = 0
    rest = _everywhere(every)
    for band, value in dialled:
        band.value = value
    obj.modifiers["Subdivision"].show_viewport = True
    for each in others:
        for now, before in zip(there, rest, strict=True):
            own, wanted = (now[name] - before[name] for name in (each.name, obj.name))
            near = KDTree(len(wanted))
            for index, point in enumerate(before[obj.name]):
                near.insert(point, index)
            near.balance()
            wanted = wanted[[near.find(point)[1] for point in before[each.name]]]
            off = np.linalg.norm(own - wanted, axis=1).mean()
            assert off < 0.8 * np.linalg.norm(wanted, axis=1).mean(), each.name


def _everywhere(objects: list[bpy.types.Object]) -> list[dict[str, np.ndarray]]:
    """What is seen of objects in the world on FRAMES, by their names."""
    found = []
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        found.append({obj.name: in_world(obj) for obj in objects})
    bpy.context.scene.frame_set(FRAMES[0])
    return found


def in_world(obj: bpy.types.Object) -> np.ndarray:
    points, matrix = evaluated(obj), np.array(obj.matrix_world)
    return points @ matrix[:3, :3].T + matrix[:3, 3]
