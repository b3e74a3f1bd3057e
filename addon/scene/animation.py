"""Animating the values of shape keys, and the places of objects."""

from collections.abc import Sequence

import bpy
from mathutils import Vector


def play_in_turn(
    obj: bpy.types.Object, keys: Sequence[bpy.types.ShapeKey], frames: Sequence[int]
) -> None:
    """Keyframe each key to 1 on its frame and to 0 on those of its neighbours, linearly."""
    for index, (key, frame) in enumerate(zip(keys, frames, strict=True)):
        for other in frames[max(index - 1, 0) : index + 2]:
            key.value = 1.0 if other == frame else 0.0
            key.keyframe_insert("value", frame=other)
        _make_linear(curves_of(obj.data.shape_keys).find(key.path_from_id("value")))


def travel(obj: bpy.types.Object, places: Sequence[Vector], frames: Sequence[int]) -> None:
    """Keyframe the location of ``obj`` to each place on its frame, linearly."""
    for place, frame in zip(places, frames, strict=True):
        obj.location = place
        obj.keyframe_insert("location", frame=frame)
    for curve in curves_of(obj):
        _make_linear(curve)


def remove_animation(obj: bpy.types.Object, key: bpy.types.ShapeKey) -> None:
    """Remove the animation of a key's value, if there is any."""
    curves = curves_of(obj.data.shape_keys)
    curve = curves.find(key.path_from_id("value")) if curves is not None else None
    if curve is not None:
        curves.remove(curve)


def _make_linear(curve: bpy.types.FCurve) -> None:
    for point in curve.keyframe_points:
        point.interpolation = "LINEAR"


def curves_of(data: bpy.types.ID) -> bpy.types.bpy_prop_collection | None:
    """The curves that animate ``data``."""
    animation = data.animation_data
    if animation is None or animation.action is None:
        return None
    action = animation.action
    if hasattr(action, "fcurves"):
        return action.fcurves
    # Since Blender 5.0 they are found by the slot alone.
    bag = action.layers[0].strips[0].channelbag(animation.action_slot) if action.layers else None
    return None if bag is None else bag.fcurves
