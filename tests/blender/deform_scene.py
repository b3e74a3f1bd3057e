"""A dumbbell with constraints, and what tests ask of it."""

from __future__ import annotations

import time
from importlib import import_module

import bpy
import numpy as np
from ball import object_of
from conftest import MODULE
from shapes import dumbbell


def coordinates(data) -> np.ndarray:
    flat = np.empty(3 * len(data), dtype=np.float32)
    data.foreach_get("co", flat)
    return flat.reshape(-1, 3).astype(float)


def key_positions(obj, name="Deformation") -> np.ndarray:
    return coordinates(obj.data.shape_keys.key_blocks[name].data)


def evaluated(obj) -> np.ndarray:
    bpy.context.view_layer.update()
    graph = bpy.context.evaluated_depsgraph_get()
    return coordinates(obj.evaluated_get(graph).data.vertices)


def group(obj, name: str, indices, weight: float = 1.0) -> None:
    obj.vertex_groups.new(name=name).add([int(index) for index in indices], weight, "REPLACE")


def empty(location=(0, 0, 0)) -> bpy.types.Object:
    obj = bpy.data.objects.new("Handle", None)
    obj.location = location
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.update()
    return obj


def constrain(obj, vertex_group: str, kind: str, **choices) -> bpy.types.PropertyGroup:
    constraint = obj.spectral_tv.constraints.add()
    constraint.vertex_group, constraint.kind = vertex_group, kind
    for name, value in choices.items():
        setattr(constraint, name, value)
    return constraint


def handle(obj) -> bpy.types.Object:
    return obj.spectral_tv.constraints[1].target


def members(obj, name: str) -> np.ndarray:
    index = obj.vertex_groups[name].index
    return np.array([v.index for v in obj.data.vertices if any(g.group == index for g in v.groups)])


def dumbbell_object(algorithm: str = "CONVEX") -> bpy.types.Object:
    """A dumbbell with vertex groups at its ends, deformed by total variation unless said."""
    vertices, faces = dumbbell(n_around=24, n_along=60)
    obj = object_of("Dumbbell", vertices, faces)
    obj.select_set(True)
    obj.spectral_tv.algorithm = algorithm
    group(obj, "Feet", np.flatnonzero(vertices[:, 2] < -0.9))
    group(obj, "Head", np.flatnonzero(vertices[:, 2] > 1.8))
    return obj


def armature() -> tuple[bpy.types.Object, bpy.types.PoseBone]:
    """An armature with the bone Neck, along Z."""
    active = bpy.context.view_layer.objects.active
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bone = rig.data.edit_bones.new("Neck")
    bone.head, bone.tail = (0, 0, 0.5), (0, 0, 2)
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.view_layer.objects.active = active
    return rig, rig.pose.bones["Neck"]


def live_of(obj: bpy.types.Object):
    """What follows the handles of an object."""
    return import_module(f"{MODULE}.deformation.live").LiveDeformation(obj)


def update(live) -> bool:
    """Have it look, once it is prepared, until there is an answer; whether the shape changed."""
    is_changed = live.update()
    while live.preparation is not None or live.is_dragging:
        time.sleep(0.001)
        is_changed = live.update() or is_changed
    return is_changed


def follows(live, patience: float = 60) -> bool:
    """Have it look until the shape changed, as at weights and vertices it looks now and then."""
    ends = time.monotonic() + patience
    while not update(live):
        if time.monotonic() > ends:
            return False
        time.sleep(0.001)
    return True
