"""Animating the values of shape keys."""

from collections.abc import Sequence

import bpy


def play_in_turn(
    obj: bpy.types.Object, keys: Sequence[bpy.types.ShapeKey], frames: Sequence[int]
) -> None:
    """Keyframe each key to 1 on its frame and to 0 on those of its neighbours, linearly."""
    for index, (key, frame) in enumerate(zip(keys, frames, strict=True)):
        for other in frames[max(index - 1, 0) : index + 2]:
            key.value = 1.0 if other == frame else 0.0
            key.keyframe_insert("value", frame=other)
        curve = _curves(obj).find(key.path_from_id("value"))
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"


def remove_animation(obj: bpy.types.Object, key: bpy.types.ShapeKey) -> None:
    """Remove the animation of a key's value, if there is any."""
    curves = _curves(obj)
    curve = curves.find(key.path_from_id("value")) if curves is not None else None
    if curve is not None:
        curves.remove(curve)


def _curves(obj: bpy.types.Object) -> bpy.types.bpy_prop_collection | None:
    """The curves that animate the shape keys of ``obj``."""
    animation = obj.data.shape_keys.animation_data
    if animation is None or animation.action is None:
        return None
    action = animation.action
    if hasattr(action, "fcurves"):
        return action.fcurves
    # Since Blender 5.0 they are found by the slot alone.
    bag = action.layers[0].strips[0].channelbag(animation.action_slot) if action.layers else None
    return None if bag is None else bag.fcurves
