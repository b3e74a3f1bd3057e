"""The shape keys that hold deformations: one of the button and of Live, or one per baked frame.

Fingerprints, kept on the object, recognise them. A key that the user changed, locked or copied is
the user's. Either the first or the baked ones are shown, and the others muted: each meets the
constraints, so they would add up.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.notes import note

from ..scene import animation, shape_keys
from ..scene.applying import FOLLOWERS
from ..scene.fingerprints import Fingerprint, Likeness, digests, names, recognise
from .constraints import deformation_of

NAME = "Deformation"


@dataclass(frozen=True)
class Known:
    """The key of the last deformation and those of the last baking, None for those that are gone.

    ``kept`` are those that may be one of them, or hold the same, and are the user's now. ``names``
    are those that the keys were given.
    """

    found: list[bpy.types.ShapeKey | None]
    kept: list[bpy.types.ShapeKey]
    names: list[str]

    @classmethod
    def of(cls, obj: bpy.types.Object) -> Known:
        """Look at all keys of ``obj``."""
        deformation, keys = deformation_of(obj), obj.data.shape_keys
        if keys is None:
            return cls([None], [], [""])
        prints = _prints(obj)
        # Where vertices came or went, contents say nothing and names all.
        is_edited = deformation.vertex_count not in (0, len(obj.data.vertices))
        found, kept = [], []
        for each, (name, likeness) in zip(prints, recognise(obj, "KEY", prints), strict=True):
            candidates = [each.key] if is_edited else _candidates(obj, each, name)
            candidates = [name for name in candidates if name in keys.key_blocks]
            is_own = len(candidates) == 1 and (is_edited or likeness == Likeness.SAME)
            key = keys.key_blocks[candidates[0]] if is_own else None
            if key is not None and key.lock_shape:
                key = None
            if key is None:
                kept += [keys.key_blocks[name] for name in candidates]
            found.append(key)
        return cls(found, kept, [each.key for each in prints])

    @property
    def single(self) -> bpy.types.ShapeKey | None:
        """The key of the last deformation."""
        return self.found[0]

    @property
    def baked(self) -> list[bpy.types.ShapeKey]:
        """The keys of the last baking that are there."""
        return [key for key in self.found[1:] if key is not None]

    @property
    def renamed(self) -> list[bpy.types.ShapeKey]:
        """Those of them that have another name now."""
        pairs = zip(self.found[1:], self.names[1:], strict=True)
        return [key for key, name in pairs if key is not None and key.name != name]


def result_key(obj: bpy.types.Object) -> bpy.types.ShapeKey | None:
    """The shape key of the last deformation, renamed or not; None if it is gone or the user's."""
    deformation, keys = deformation_of(obj), obj.data.shape_keys
    key = None if keys is None else keys.key_blocks.get(deformation.key)
    if key is not None and not key.lock_shape:  # while dragging, all keys would be too many
        named = digests(obj, "KEY", [key.name])[key.name]
        if named == deformation.digest:
            return key
    return Known.of(obj).single


def write(obj: bpy.types.Object, displacement: np.ndarray) -> bpy.types.ShapeKey:
    """Write a displacement (V, 3) as the shape key of the deformation, at full value if new."""
    deformation, key = deformation_of(obj), result_key(obj)
    if key is None:
        keep(Known.of(obj).kept)
        (key,) = shape_keys.add_displacements(obj, [NAME], displacement[np.newaxis])
        key.value = 1.0
    else:
        if key.name != deformation.key:
            note(f"{key.name!r} is written over: it was {deformation.key!r}")
        shape_keys.set_displacement(obj, key, displacement)
    deformation.take(obj, "KEY", key.name)
    deformation.vertex_count = len(obj.data.vertices)
    return key


def follow(obj: bpy.types.Object) -> Callable[[], None]:
    """Note which keys hold deformations; the function returned takes their fingerprints anew."""
    names = [None if key is None else key.name for key in Known.of(obj).found]

    def renew() -> None:
        for each, name in zip(_prints(obj), names, strict=True):
            if name is not None:
                each.take(obj, "KEY", name)
        deformation_of(obj).vertex_count = len(obj.data.vertices)

    return renew


FOLLOWERS.append(follow)


def keep(keys: Sequence[bpy.types.ShapeKey]) -> None:
    """Mute keys that are the user's now, and note that they are kept."""
    for key in keys:
        key.mute = True
    if keys:
        names = told([key.name for key in keys])
        note(f"kept and muted, as changed, renamed, locked or copied since: {names}")


def show(obj: bpy.types.Object) -> None:
    """Have the last deformation be seen, those of a baking not, and note what is in the way."""
    known = Known.of(obj)
    key = known.single
    _mute(known.baked)
    key.mute = False
    if animation.animation_of(key, "mute"):
        note(f"{key.name!r} is not seen where it is muted: that is animated")
    how = animation.animation_of(key, "value")
    if how:
        note(f"the value of {key.name!r} is {how}, {key.value:.3g} now: 1 shows all of it")
    elif key.value == 0:
        key.value = 1.0
        note(f"{key.name!r} was at 0, and is at 1 now")
    elif key.value != 1:
        note(f"{key.name!r} is at {key.value:.3g}: 1 shows all of it")
    _note_hidden(obj, [key])


def show_baked(obj: bpy.types.Object) -> None:
    """Have the baked keys be seen, the single one not, and note what is in the way."""
    known = Known.of(obj)
    _mute([] if known.single is None else [known.single])
    driven = [key.name for key in known.baked if animation.animation_of(key, "value") == "driven"]
    if driven:
        note(f"{told(driven)}: driven, so that the keyframes do not act")
    _note_hidden(obj, known.baked)


def hide(obj: bpy.types.Object) -> None:
    """Have neither the last deformation nor the baked keys be seen."""
    known = Known.of(obj)
    _mute([*([] if known.single is None else [known.single]), *known.baked])


def told(names: Sequence[str]) -> str:
    """Tell the first of several names, and how many more there are."""
    more = f" and {len(names) - 1} more" if len(names) > 1 else ""
    return f"{names[0]!r}{more}"


def _prints(obj: bpy.types.Object) -> list[Fingerprint]:
    """Fingerprints of the last deformation, and of each frame of the last baking."""
    deformation = deformation_of(obj)
    return [deformation, *deformation.baked]


def _candidates(obj: bpy.types.Object, written: Fingerprint, name: str) -> list[str]:
    """Names of all keys that may be what was written, if ``name`` is the one recognised."""
    if not written.key:
        return []
    present = names(obj, "KEY")
    if name == written.key:
        return [name]
    if name:  # renamed, unless the one of that name is it, and this one a copy of before
        named = obj.data.shape_keys.key_blocks.get(written.key)
        is_changed = named is not None and written.likeness(named) != Likeness.OTHER
        return [name, written.key] if is_changed else [name]
    copies = digests(obj, "KEY", present)
    return [each for each, found in copies.items() if written.digest and found == written.digest]


def _mute(keys: Sequence[bpy.types.ShapeKey]) -> None:
    seen = [key for key in keys if not key.mute]
    for key in seen:
        key.mute = True
    if seen:
        note(f"muted, as it would be added: {told([key.name for key in seen])}")
    animated = [key.name for key in keys if animation.animation_of(key, "mute")]
    if animated:
        note(f"{told(animated)} would be added where it is not muted: that is animated")


def _note_hidden(obj: bpy.types.Object, keys: Sequence[bpy.types.ShapeKey]) -> None:
    active = obj.active_shape_key
    if obj.show_only_shape_key and list(keys) != [active]:
        setting = obj.bl_rna.properties["show_only_shape_key"].name
        note(f"nothing is seen of it: {setting} shows {active.name!r} alone")
    for key in keys:
        if key.vertex_group:
            note(f"{key.name!r} is limited to the vertex group {key.vertex_group!r}")
