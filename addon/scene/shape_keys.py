"""Writing displacements as relative shape keys."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager

import bpy
import numpy as np

from .animation import Played, remove_animation
from .surface import basis_coordinates

# −1 removes a band, 0 leaves it, 1 doubles it; beyond that is exaggeration.
SLIDER_RANGE = (-10.0, 10.0)


def add_displacements(
    obj: bpy.types.Object, names: Sequence[str], displacements: Iterable[np.ndarray]
) -> list[bpy.types.ShapeKey]:
    """Add one shape key relative to Basis per displacement, at value 0.

    ``displacements``, K of (V, 3), are in object space. Everything else on the object, the active
    shape key included, stays as it was; a mesh without shape keys is given its Basis.
    """
    mesh = obj.data
    active = obj.active_shape_key_index
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


@contextmanager
def all_or_none(obj: bpy.types.Object) -> Iterator[None]:
    """Take back all shape keys and animation of their values that are added where it fails."""
    keys = obj.data.shape_keys
    before = None if keys is None else {key.name for key in keys.key_blocks}
    active, played = obj.active_shape_key_index, Played.by(keys)
    try:
        yield
    except BaseException:
        keys = obj.data.shape_keys
        if keys is not None:
            for key in reversed(keys.key_blocks):
                if before is not None and key.name not in before:
                    remove_animation(obj, key)
                    obj.shape_key_remove(key)
            played.restore(keys)
            if before is None:
                obj.shape_key_clear()
        obj.active_shape_key_index = active
        raise


def set_displacement(
    obj: bpy.types.Object, key: bpy.types.ShapeKey, displacement: np.ndarray
) -> None:
    """Give a shape key of ``obj`` another displacement from Basis, (V, 3) in object space."""
    _set_coordinates(key, basis_coordinates(obj.data) + displacement)
    obj.data.update_tag()


def _set_coordinates(key: bpy.types.ShapeKey, coordinates: np.ndarray) -> None:
    key.data.foreach_set("co", coordinates.astype(np.float32).ravel())


def _add_key(obj: bpy.types.Object, name: str, coordinates: np.ndarray) -> bpy.types.ShapeKey:
    key = obj.shape_key_add(name=name, from_mix=False)
    key.relative_key = obj.data.shape_keys.reference_key
    key.slider_min, key.slider_max = SLIDER_RANGE
    key.value = 0.0
    _set_coordinates(key, coordinates)
    return key
