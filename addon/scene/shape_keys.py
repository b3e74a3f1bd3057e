"""Shape keys as displacements: read, written, and removed without moving keys relative to them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import bpy
from spectral_tv.bands.gains import VALUES
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

from .channels import is_of, own_actions, remove_channels
from .coordinates import basis_coordinates, points
from .drivers import retarget_drivers
from .mix import key_displacement, keys_of
from .names import free_name, taken_names
from .whole import whole

# −1 removes a band, 0 leaves it, 1 doubles it; beyond that is exaggeration.
USUAL_RANGE = (-1.0, 2.0)
# Blender allows no more.
SLIDER_RANGE = VALUES


def key_shape(mesh: bpy.types.Mesh, name: str, use: str) -> np.ndarray:
    """The shape that is seen with a key alone, at value 1, (V, 3) in object space.

    Raises Refusal, with its ``use``, if there is no such key.
    """
    if name not in keys_of(mesh):
        raise Refusal(f"there is no shape key {name!r} {use}")
    return basis_coordinates(mesh) + key_displacement(mesh.shape_keys.key_blocks[name])


def add_displacements(
    obj: bpy.types.Object, names: Sequence[str], displacements: Iterable[np.ndarray]
) -> list[bpy.types.ShapeKey]:
    """Add one shape key relative to Basis per displacement, at value 0; all of them or none.

    ``displacements``, K of (V, 3), are in object space. Everything else on the object, the active
    shape key included, stays as it was; a mesh without shape keys is given its Basis.
    """
    mesh = obj.data
    active = obj.active_shape_key_index
    with whole(obj):
        if mesh.shape_keys is None:
            obj.shape_key_add(name="Basis", from_mix=False)
        basis = basis_coordinates(mesh)
        keys = [
            _add_key(obj, name, basis + displacement)
            for name, displacement in zip(names, displacements, strict=True)
        ]
    obj.active_shape_key_index = active
    mesh.update_tag()
    return keys


def set_displacement(
    obj: bpy.types.Object, key: bpy.types.ShapeKey, displacement: np.ndarray
) -> None:
    """Have a shape key of ``obj`` move the vertices by (V, 3), in object space.

    Keys that are relative to it come along, so that they move the vertices as before.
    """
    if key.relative_key in (None, key):
        key.relative_key = key.id_data.reference_key
    before = points(key.points)
    after = points(key.relative_key.points) + displacement
    _set_coordinates(key, after)
    _shift_relatives(key, after - before)
    obj.data.update_tag()


def make_room(key: bpy.types.ShapeKey, value: float) -> None:
    """Widen the slider of a key for a value, unless somebody has drawn its end in."""
    if value < key.slider_min <= USUAL_RANGE[0]:
        key.slider_min = max(math.floor(value), SLIDER_RANGE[0])
    if value > key.slider_max >= USUAL_RANGE[1]:
        key.slider_max = min(math.ceil(value), SLIDER_RANGE[1])


def remove_key(obj: bpy.types.Object, key: bpy.types.ShapeKey) -> None:
    """Remove a shape key with all that animates it.

    Keys that are relative to it are made relative to Basis, and move the vertices as before. The
    active key of each object stays it, unless it is the one that is removed.
    """
    keys = key.id_data
    active = [
        (user, user.active_shape_key.name)
        for user in bpy.data.objects
        if user.data == obj.data and user.active_shape_key not in (None, key)
    ]
    basis = points(keys.reference_key.points)
    for other in keys.key_blocks:
        if other != key and other.relative_key == key:
            moved = key_displacement(other)
            shift = basis + moved - points(other.points)
            _set_coordinates(other, basis + moved)
            other.relative_key = keys.reference_key
            _shift_relatives(other, shift)
    remove_channels(keys, is_of(key))
    obj.shape_key_remove(key)
    for user, name in active:
        user.active_shape_key_index = keys.key_blocks.find(name)


def rename_key(obj: bpy.types.Object, key: bpy.types.ShapeKey, name: str) -> None:
    """Give a shape key another name, which is free; what animates and what reads it goes on.

    Blender renames what actions and drivers say of it. An action that animates others too, or is
    linked, is copied first, as it would lose them.
    """
    old = key.name
    own_actions(key.id_data, is_of(key), "these shape keys")
    key.name = name
    retarget_drivers(obj.data, {old: key.name})


def move_key(obj: bpy.types.Object, key: bpy.types.ShapeKey, place: int) -> None:
    """Move a shape key up the list to a place, as far as Blender does that now."""
    blocks = key.id_data.key_blocks
    with bpy.context.temp_override(object=obj, active_object=obj, selected_objects=[obj]):
        while (now := blocks.find(key.name)) > place:
            obj.active_shape_key_index = now
            if not bpy.ops.object.shape_key_move.poll():
                return
            bpy.ops.object.shape_key_move(type="UP")
            if blocks.find(key.name) != now - 1:
                return


def _shift_relatives(key: bpy.types.ShapeKey, shift: np.ndarray) -> None:
    """Move all keys that are relative to ``key``, at however many removes, by (V, 3)."""
    moved, pending = {key.name}, [key]
    while pending:
        reference = pending.pop()
        for other in key.id_data.key_blocks:
            if other.name not in moved and other.relative_key == reference:
                _set_coordinates(other, points(other.points) + shift)
                moved.add(other.name)
                pending.append(other)


def _set_coordinates(key: bpy.types.ShapeKey, coordinates: np.ndarray) -> None:
    key.points.foreach_set("co", coordinates.astype(np.float32).ravel())


def _add_key(obj: bpy.types.Object, name: str, coordinates: np.ndarray) -> bpy.types.ShapeKey:
    name = free_name(name, "", taken_names(obj, "KEY"))
    key = obj.shape_key_add(name=name, from_mix=False)
    key.relative_key = obj.data.shape_keys.reference_key
    key.slider_min, key.slider_max = USUAL_RANGE
    key.value = 0.0
    _set_coordinates(key, coordinates)
    return key
