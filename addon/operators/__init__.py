"""The operators under bpy.ops.spectral_tv; a new one is a new file and a line here."""

import bpy

from .decompose import SPECTRAL_TV_OT_decompose

_register_classes, _unregister_classes = bpy.utils.register_classes_factory(
    (SPECTRAL_TV_OT_decompose,)
)


def register() -> None:
    """Register every operator."""
    _register_classes()


def unregister() -> None:
    """Unregister every operator."""
    _unregister_classes()
