"""The operators under bpy.ops.spectral_tv; a new one is a class in a file's CLASSES."""

import bpy

from . import (
    _job,
    _timers,
    accuracy,
    apply_modifier,
    attributes,
    bake_deformation,
    caricature,
    constraints,
    cosegment,
    decompose,
    deform,
    eigenset,
    filter,
    image,
    live,
    mix,
    select_faulty,
    values,
)

_FILES = (
    _job,
    decompose,
    accuracy,
    filter,
    mix,
    apply_modifier,
    caricature,
    constraints,
    deform,
    live,
    bake_deformation,
    cosegment,
    attributes,
    eigenset,
    values,
    image,
    select_faulty,
)

register, _unregister = bpy.utils.register_classes_factory(
    [cls for file in _FILES for cls in file.CLASSES]
)


def unregister() -> None:
    """Unregister them, with what those that still run leave behind."""
    _timers.remove_all()
    _unregister()
