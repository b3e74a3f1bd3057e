"""What animates shape keys and others: F-curves in the action and in NLA strips, and drivers."""

from collections.abc import Callable, Iterator, Sequence

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.notes import note


@dataclass(frozen=True)
class Animated:
    """The action of a shape-key block or of one of its strips, and the slot that is its own.

    ``user`` is what refers to the action: the animation data, or a strip.
    """

    user: bpy.types.AnimData | bpy.types.NlaStrip
    action: bpy.types.Action

    @property
    def curves(self) -> bpy.types.bpy_prop_collection | None:
        """The curves for the keys; None if there are none."""
        action = self.action
        if hasattr(self.user, "action_slot"):  # since Blender 4.4
            if self.user.action_slot is None or not action.layers or not action.layers[0].strips:
                return None
            bag = action.layers[0].strips[0].channelbag(self.user.action_slot)
            return None if bag is None else bag.fcurves
        return action.fcurves

    @property
    def identity(self) -> tuple[int, int]:
        """The same for all that refer to the same curves."""
        slot = getattr(self.user, "action_slot", None)
        return self.action.as_pointer(), 0 if slot is None else slot.handle

    @property
    def adds(self) -> bool:
        """Whether its curves are added to what is below, rather than taking its place."""
        return isinstance(self.user, bpy.types.NlaStrip) and self.user.blend_type != "REPLACE"

    @property
    def is_shared(self) -> bool:
        """Whether the same curves animate something else too."""
        slot = getattr(self.user, "action_slot", None)
        users = self.action.users - self.action.use_fake_user if slot is None else len(slot.users())
        return users > 1

    def with_own_action(self) -> "Animated":
        """The same with a copy of the action that nothing else refers to."""
        slot = getattr(self.user, "action_slot", None)
        place = None if slot is None else self.action.slots.find(slot.identifier)
        self.user.action = self.action.copy()
        if place is not None:
            self.user.action_slot = self.user.action.slots[place]
        return Animated(self.user, self.user.action)


def actions_of(data: bpy.types.ID) -> list[Animated]:
    """All actions that animate shape keys or others: the active one, and those of strips."""
    animation = getattr(data, "animation_data", None)
    if animation is None:
        return []
    strips = [strip for track in animation.nla_tracks for strip in _strips(track.strips)]
    return [Animated(user, user.action) for user in (animation, *strips) if user.action is not None]


def own_actions(block: bpy.types.ID, is_moved: Callable[[str], bool], whose: str) -> list[Animated]:
    """The actions with curves of some of the paths of a data-block, each of them the block's own.

    Those of other files, and those that animate others too, are copied, which is noted.
    """
    found: dict[tuple[int, int], Animated] = {}
    for animated in actions_of(block):
        curves = animated.curves
        if curves is None or not any(is_moved(each.data_path) for each in curves):
            continue
        own, name = animated, animated.action.name
        if animated.action.library is not None:
            note(f"{name!r} is linked from another file; {whose} have a copy now")
            own = animated.with_own_action()
        elif animated.is_shared:
            note(f"{name!r} animates others too; {whose} have a copy now")
            own = animated.with_own_action()
        found.setdefault(own.identity, own)
    return list(found.values())


def drivers_of(data: bpy.types.ID) -> Sequence[bpy.types.FCurve]:
    """The drivers of a data-block's properties."""
    animation = getattr(data, "animation_data", None)
    return () if animation is None else animation.drivers


def curves_and_drivers(data: bpy.types.ID) -> Iterator[bpy.types.FCurve]:
    """All that animates properties of a data-block."""
    for animated in actions_of(data):
        yield from animated.curves or ()
    yield from drivers_of(data)


def key_path(key: bpy.types.ShapeKey, name: str = "") -> str:
    """The path from the block to a property of a key, or what all such paths begin with."""
    return f'key_blocks["{bpy.utils.escape_identifier(key.name)}"].{name}'


def is_of(key: bpy.types.ShapeKey) -> Callable[[str], bool]:
    """What tells whether a path is to a property of a key."""
    beginning = key_path(key)
    return lambda path: path.startswith(beginning)


def animation_at(block: bpy.types.ID, path: str) -> str:
    """How a property of a data-block is animated, "keyed" or "driven"; nothing if it is not."""
    if block.animation_data is not None and block.animation_data.drivers.find(path) is not None:
        return "driven"
    curves = [animated.curves for animated in actions_of(block)]
    found = any(each is not None and each.find(path) is not None for each in curves)
    return "keyed" if found else ""


def insert_keyframe(block: bpy.types.ID, path: str, frame: float) -> bool:
    """Insert a keyframe for a property of a data-block, and tell whether Blender did."""
    animation = block.animation_data
    action = None if animation is None else animation.action
    if action is not None and action.library is not None:  # Blender 4 would, and not save it
        return False
    try:
        return block.keyframe_insert(path, frame=frame)
    except RuntimeError:
        return False


def remove_channels(block: bpy.types.ID, is_gone: Callable[[str], bool]) -> None:
    """Remove the curves and drivers of some paths; those of linked actions stay."""
    for animated in actions_of(block):
        if animated.curves is not None and animated.action.library is None:
            _remove(animated.curves, is_gone)
    if block.animation_data is not None:
        _remove(block.animation_data.drivers, is_gone)


def drop_empty_action(block: bpy.types.ID | None) -> None:
    """Have a data-block play no action that has nothing for it any more."""
    animation = getattr(block, "animation_data", None)
    action = None if animation is None else animation.action
    if action is None or action.library is not None or Animated(animation, action).curves:
        return
    slot = getattr(animation, "action_slot", None)
    animation.action = None
    if action.users == action.use_fake_user:
        bpy.data.actions.remove(action)
    elif slot is not None and not slot.users():
        action.slots.remove(slot)
    if not animation.drivers and not animation.nla_tracks:
        block.animation_data_clear()


def _remove(curves: bpy.types.bpy_prop_collection, is_gone: Callable[[str], bool]) -> None:
    for curve in [each for each in curves if is_gone(each.data_path)]:
        curves.remove(curve)


def _strips(strips: bpy.types.bpy_prop_collection) -> Iterator[bpy.types.NlaStrip]:
    """Strips, and those in meta strips."""
    for strip in strips:
        yield strip
        yield from _strips(strip.strips)
