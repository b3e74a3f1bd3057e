"""Animating the values of shape keys, and the places of objects."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import bpy
from mathutils import Vector
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

from .channels import Animated, animation_at, insert_keyframe, is_of, key_path, remove_channels
from .frames import curve_time


def check_animatable(keys: bpy.types.Key) -> None:
    """Raise Refusal if no keyframes of shape keys can be inserted that then play as they are."""
    animation = keys.animation_data
    if animation is None:
        return
    if animation.use_tweak_mode:
        raise Refusal("its shape keys are in Tweak Mode of the NLA Editor; leave that first")
    action = animation.action
    if action is not None and (action.library or action.override_library):
        raise Refusal(
            f"the action {action.name!r} of its shape keys belongs to another file; make it local "
            "first"
        )
    is_mixed = animation.action_influence < 1 or animation.action_blend_type != "REPLACE"
    tracks = animation.nla_tracks if animation.use_nla else ()
    if any(track.is_solo for track in tracks) or (tracks and is_mixed):
        note("the NLA Editor mixes the action of the shape keys: they may not play as baked")


@contextmanager
def as_before(obj: bpy.types.Object) -> Iterator[None]:
    """If the block fails, restore the animation of the shape keys of ``obj``.

    Keys that the block added, and all that animates them, may be removed afterwards.
    """
    keys = obj.data.shape_keys
    names = set() if keys is None else set(keys.key_blocks.keys())
    animation = None if keys is None else keys.animation_data
    action = None if animation is None else animation.action
    slot = getattr(animation, "action_slot", None)
    slots, actions = _slots(action), set(bpy.data.actions)
    try:
        yield
    except BaseException:
        keys = obj.data.shape_keys
        if keys is None:
            raise
        for key in keys.key_blocks:
            if key.name not in names:
                remove_channels(keys, is_of(key))
        if animation is None:
            keys.animation_data_clear()
        elif animation.action != action:
            animation.action = action
            if slot is not None:
                animation.action_slot = slot
        for identifier in _slots(action) - slots:
            action.slots.remove(action.slots[identifier])
        for each in set(bpy.data.actions) - actions:
            bpy.data.actions.remove(each)
        raise


def play_in_turn(
    obj: bpy.types.Object, keys: Sequence[bpy.types.ShapeKey], frames: Sequence[int]
) -> None:
    """Keyframe each key to 1 on its frame and to 0 on those of its neighbours, linearly.

    Raises Refusal if Blender inserts no keyframes.
    """
    data, scene = obj.data.shape_keys, bpy.context.scene
    _have_own_action(data)
    for index, (key, frame) in enumerate(zip(keys, frames, strict=True)):
        for other in frames[max(index - 1, 0) : index + 2]:
            key.value = 1.0 if other == frame else 0.0
            if not insert_keyframe(data, key_path(key, "value"), curve_time(scene, other)):
                raise Refusal(f"Blender inserted no keyframe of {key.name!r}")
        animation = data.animation_data
        _make_linear(Animated(animation, animation.action).curves.find(key_path(key, "value")))


def travel(obj: bpy.types.Object, places: Sequence[Vector], frames: Sequence[int]) -> None:
    """Keyframe the location of ``obj`` to each place on its frame, linearly."""
    for place, frame in zip(places, frames, strict=True):
        obj.location = place
        obj.keyframe_insert("location", frame=curve_time(bpy.context.scene, frame))
    for curve in Animated(obj.animation_data, obj.animation_data.action).curves:
        _make_linear(curve)


def animation_of(key: bpy.types.ShapeKey, name: str) -> str:
    """How a property of a key is animated, "keyed" or "driven"; nothing if it is not."""
    return animation_at(key.id_data, key_path(key, name))


def _have_own_action(keys: bpy.types.Key) -> None:
    """Give shape keys a copy of their action if others play the same."""
    animation = keys.animation_data
    if animation is None or animation.action is None:
        return
    played = Animated(animation, animation.action)
    if played.is_shared:
        note(
            f"the action {animation.action.name!r} was shared; these shape keys have a copy of "
            "their own now"
        )
        played.with_own_action()


def curves_of(data: bpy.types.ID) -> bpy.types.bpy_prop_collection | None:
    """The curves of the action that animates ``data``; None if there are none."""
    animation = data.animation_data
    if animation is None or animation.action is None:
        return None
    return Animated(animation, animation.action).curves


def _make_linear(curve: bpy.types.FCurve) -> None:
    for point in curve.keyframe_points:
        point.interpolation = "LINEAR"


def _slots(action: bpy.types.Action | None) -> set[str]:
    """Identifiers of an action's parts; it has none before Blender 4.4."""
    return {slot.identifier for slot in getattr(action, "slots", ())}
