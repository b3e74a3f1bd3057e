"""Animating the values of shape keys, and the places of objects."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import bpy
from mathutils import Vector

from .frames import curve_time
from .notes import note
from .objects import Refusal


@dataclass(frozen=True)
class Played:
    """The action that a data-block plays, and all that there are, so that others can be removed."""

    is_animated: bool
    action: bpy.types.Action | None
    slot: bpy.types.bpy_struct | None
    slots: frozenset[str]
    actions: frozenset[bpy.types.Action]

    @classmethod
    def by(cls, data: bpy.types.ID | None) -> "Played":
        """What ``data`` plays now."""
        animation = None if data is None else data.animation_data
        action = None if animation is None else animation.action
        slots = frozenset(slot.identifier for slot in getattr(action, "slots", ()))
        slot = None if action is None else _slot(animation)
        return cls(animation is not None, action, slot, slots, frozenset(bpy.data.actions))

    def restore(self, data: bpy.types.ID) -> None:
        """Have ``data`` play that again."""
        if not self.is_animated:
            data.animation_data_clear()
        elif data.animation_data.action != self.action:
            data.animation_data.action = self.action
            if self.slot is not None:
                data.animation_data.action_slot = self.slot
        for slot in list(getattr(self.action, "slots", ())):
            if slot.identifier not in self.slots:
                self.action.slots.remove(slot)
        for action in set(bpy.data.actions) - self.actions:
            bpy.data.actions.remove(action)


def check_animatable(data: bpy.types.ID) -> None:
    """Raise Refusal if no keyframes of ``data`` can be inserted that then play as they are."""
    animation = data.animation_data
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


def play_in_turn(
    obj: bpy.types.Object, keys: Sequence[bpy.types.ShapeKey], frames: Sequence[int]
) -> None:
    """Keyframe each key to 1 on its frame and to 0 on those of its neighbours, linearly.

    Raises Refusal if Blender inserts no keyframes.
    """
    data = obj.data.shape_keys
    _have_own_action(data)
    for index, (key, frame) in enumerate(zip(keys, frames, strict=True)):
        for other in frames[max(index - 1, 0) : index + 2]:
            key.value = 1.0 if other == frame else 0.0
            _insert(key, "value", other)
        _make_linear(_curve(data, key.path_from_id("value")))


def travel(obj: bpy.types.Object, places: Sequence[Vector], frames: Sequence[int]) -> None:
    """Keyframe the location of ``obj`` to each place on its frame, linearly."""
    for place, frame in zip(places, frames, strict=True):
        obj.location = place
        _insert(obj, "location", frame)
    for curve in _curves(obj):
        _make_linear(curve)


def remove_animation(obj: bpy.types.Object, key: bpy.types.ShapeKey) -> None:
    """Remove the animation of a key's value, if there is any."""
    data = obj.data.shape_keys
    curve = _curve(data, key.path_from_id("value"))
    if curve is not None:
        _curves(data).remove(curve)


def animation_of(key: bpy.types.ShapeKey, name: str) -> str:
    """How a property of a key is animated, "keyed" or "driven"; nothing if it is not."""
    path, animation = key.path_from_id(name), key.id_data.animation_data
    if animation is None:
        return ""
    if animation.drivers.find(path) is not None:
        return "driven"
    strips = [strip.action for track in animation.nla_tracks for strip in track.strips]
    found = _curve(key.id_data, path) is not None or any(
        curve.data_path == path for action in strips if action for curve in _all_curves(action)
    )
    return "keyed" if found else ""


def _insert(thing: bpy.types.bpy_struct, name: str, frame: int) -> None:
    time = curve_time(bpy.context.scene, frame)
    try:
        done = thing.keyframe_insert(name, frame=time)
    except (RuntimeError, TypeError) as error:
        raise Refusal(f"no keyframe could be inserted: {error}") from error
    if not done:
        raise Refusal(f"Blender inserted no keyframe of {thing.path_from_id(name)}")


def _have_own_action(data: bpy.types.ID) -> None:
    """Give ``data`` a copy of its action if others of its kind play the same."""
    animation = data.animation_data
    if animation is None or animation.action is None:
        return
    action, slot = animation.action, _slot(animation)
    others = [other.animation_data for other in bpy.data.shape_keys if other != data]
    if not any(
        each is not None and each.action == action and _slot(each) == slot for each in others
    ):
        return
    animation.action = action.copy()
    if slot is not None and animation.action_slot is None:
        animation.action_slot = animation.action.slots[slot.identifier]
    note(
        f"the action {action.name!r} was shared with other shape keys; these have a copy of their "
        "own now"
    )


def _make_linear(curve: bpy.types.FCurve) -> None:
    for point in curve.keyframe_points:
        point.interpolation = "LINEAR"


def _slot(animation: bpy.types.AnimData) -> bpy.types.bpy_struct | None:
    """Which part of the action is played; None before Blender 4.4, where all of it is."""
    return getattr(animation, "action_slot", None)


def _curve(data: bpy.types.ID, path: str) -> bpy.types.FCurve | None:
    """The curve that animates a property of ``data``."""
    curves = _curves(data)
    return None if curves is None else curves.find(path)


def _curves(data: bpy.types.ID) -> bpy.types.bpy_prop_collection | None:
    """The curves that animate ``data``."""
    animation = data.animation_data
    if animation is None or animation.action is None:
        return None
    action = animation.action
    if not hasattr(action, "slots"):
        return action.fcurves
    # Actions have parts for several data-blocks since Blender 4.4.
    if animation.action_slot is None:
        return None
    bags = [strip.channelbag(animation.action_slot) for strip in _strips(action)]
    return next((bag.fcurves for bag in bags if bag is not None), None)


def _all_curves(action: bpy.types.Action) -> Iterator[bpy.types.FCurve]:
    """All curves of an action, whatever they animate."""
    if not hasattr(action, "slots"):
        yield from action.fcurves
        return
    for strip in _strips(action):
        for bag in strip.channelbags:
            yield from bag.fcurves


def _strips(action: bpy.types.Action) -> list[bpy.types.bpy_struct]:
    return [strip for layer in action.layers for strip in layer.strips]
