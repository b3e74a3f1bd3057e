"""The shape keys that hold deformations: one of the button and of Live, or one per baked frame.

They are known by a record on the object. Either the one or the others are seen: all hold what the
constraints ask for, and would add up.
"""

from collections.abc import Sequence

import bpy
import numpy as np

from ..scene.animation import animation_of
from ..scene.coordinates import coordinates
from ..scene.notes import note
from ..scene.objects import Refusal
from ..scene.records import digest
from ..scene.shape_keys import add_displacements, all_or_none, set_displacement
from .constraints import deformation_of

NAME = "Deformation"


def result_key(obj: bpy.types.Object) -> bpy.types.ShapeKey | None:
    """The shape key that holds the last deformation, renamed or not; None if it is gone.

    It is gone too where one of several may be it, as copies are the user's.
    """
    found = _candidates(obj)
    return found[0] if len(found) == 1 else None


def baked_keys(obj: bpy.types.Object) -> list[bpy.types.ShapeKey]:
    """The shape keys of the last baking that are still there."""
    deformation = deformation_of(obj)
    names = {deformation.key, *(entry.name for entry in deformation.baked)}
    keys: list[bpy.types.ShapeKey] = []
    for entry in deformation.baked:
        found = _recorded(obj, entry.name, entry.digest, names)
        if len(found) == 1 and found[0] not in keys:
            keys += found
    return keys


def check_unlocked(keys: Sequence[bpy.types.ShapeKey]) -> None:
    """Raise Refusal if one of the keys that are to be overwritten or removed is locked."""
    for key in keys:
        if key.lock_shape:
            raise Refusal(
                f"the shape key {key.name!r} is locked, and would be overwritten; unlock it; a "
                "duplicate keeps what it holds"
            )


def write(obj: bpy.types.Object, displacement: np.ndarray) -> bpy.types.ShapeKey:
    """Write a displacement (V, 3) as the shape key of the deformation, at full value if new."""
    deformation = deformation_of(obj)
    key = result_key(obj)
    if key is None:
        _keep_copies(obj)
        with all_or_none(obj):
            (key,) = add_displacements(obj, [NAME], displacement[np.newaxis])
        key.value = 1.0
    else:
        note_overwriting(key, deformation.key, deformation.digest)
        set_displacement(obj, key, displacement)
    deformation.key, deformation.digest = key.name, digest(coordinates(key.data))
    return key


def note_overwriting(key: bpy.types.ShapeKey, name: str, fingerprint: str) -> None:
    """Note what is lost of a key that was recorded as ``name``, if it changed since."""
    if key.name != name:
        note(f"{key.name!r}, which was {name!r}, is overwritten; a duplicate would be kept")
    elif fingerprint and digest(coordinates(key.data)) != fingerprint:
        note(f"{key.name!r} was edited since it was written; that is overwritten")


def show(obj: bpy.types.Object) -> None:
    """Have the last deformation be seen, those of a baking not, and note what is in the way."""
    key = result_key(obj)
    _mute(baked_keys(obj))
    _unmute(key)
    animation = animation_of(key, "value")
    if animation:
        note(f"the value of {key.name!r} is {animation}, {key.value:.3g} now: 1 shows all of it")
    elif key.value == 0:
        key.value = 1.0
        note(f"{key.name!r} was at 0, and is at 1 now")
    elif key.value != 1:
        note(f"{key.name!r} is at {key.value:.3g}: 1 shows all of it")
    _note_hidden(obj, [key])


def show_baked(obj: bpy.types.Object) -> None:
    """Have the baked keys be seen, the single one not, and note what is in the way."""
    single = result_key(obj)
    _mute([] if single is None else [single])
    baked = baked_keys(obj)
    driven = [key.name for key in baked if animation_of(key, "value") == "driven"]
    if driven:
        note(f"{told(driven)}: driven, so that the keyframes do not act")
    _note_hidden(obj, baked)


def told(names: Sequence[str]) -> str:
    """Tell the first of several names, and how many more there are."""
    more = f" and {len(names) - 1} more" if len(names) > 1 else ""
    return f"{names[0]!r}{more}"


def _candidates(obj: bpy.types.Object) -> list[bpy.types.ShapeKey]:
    """The last deformation, or all that may be it."""
    deformation = deformation_of(obj)
    others = {entry.name for entry in deformation.baked}
    return _recorded(obj, deformation.key, deformation.digest, others)


def _recorded(
    obj: bpy.types.Object, name: str, fingerprint: str, others: set[str]
) -> list[bpy.types.ShapeKey]:
    """The key that has the recorded name and shape, else all that have one of them.

    Basis, and the keys that are recorded as ``others``, do not count for their shape alone.
    """
    keys = obj.data.shape_keys
    if keys is None or not name:
        return []
    named = keys.key_blocks.get(name)
    if not fingerprint or (named is not None and digest(coordinates(named.data)) == fingerprint):
        return [named] if named is not None else []
    alike = [
        key
        for key in keys.key_blocks
        if key.name not in others
        and key != keys.reference_key
        and digest(coordinates(key.data)) == fingerprint
    ]
    return alike if named is None else [named, *alike]


def _keep_copies(obj: bpy.types.Object) -> None:
    """Mute what may be the last deformation, and note that it is kept."""
    copies = _candidates(obj)
    for key in copies:
        key.mute = True
    if copies:
        names = told([key.name for key in copies])
        note(f"{names} hold the last deformation: they are kept, muted, and a new key is made")


def _mute(keys: Sequence[bpy.types.ShapeKey]) -> None:
    seen = [key for key in keys if not key.mute]
    for key in seen:
        key.mute = True
    if seen:
        note(f"muted, as it would be added: {told([key.name for key in seen])}")
    animated = [key.name for key in keys if animation_of(key, "mute")]
    if animated:
        note(f"{told(animated)} would be added where it is not muted: that is animated")


def _unmute(key: bpy.types.ShapeKey) -> None:
    key.mute = False
    if animation_of(key, "mute"):
        note(f"{key.name!r} is not seen where it is muted: that is animated")


def _note_hidden(obj: bpy.types.Object, keys: Sequence[bpy.types.ShapeKey]) -> None:
    active, basis = obj.active_shape_key, obj.data.shape_keys.reference_key
    if obj.show_only_shape_key and list(keys) != [active]:
        setting = obj.bl_rna.properties["show_only_shape_key"].name
        note(f"nothing is seen of it: {setting} shows {active.name!r} alone")
    for key in keys:
        if key.vertex_group:
            note(f"{key.name!r} is limited to the vertex group {key.vertex_group!r}")
        if key.relative_key != basis:
            key.relative_key = basis
            note(f"{key.name!r} is relative to {basis.name!r} again")
