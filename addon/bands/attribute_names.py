"""Attributes that are bands are renamed by hand: inputs and records follow."""

import bpy

from ..scene.records import record_of, renew_bands

# Whose subscriptions they are.
_OWNER = object()


def start() -> None:
    """Begin to watch; loading a file ends it."""
    bpy.msgbus.clear_by_owner(_OWNER)
    bpy.msgbus.subscribe_rna(
        key=(bpy.types.Attribute, "name"), owner=_OWNER, args=(), notify=follow
    )


def stop() -> None:
    """Watch no more."""
    bpy.msgbus.clear_by_owner(_OWNER)


def follow() -> None:
    """Have the bands of the active object follow the names of attributes."""
    obj = bpy.context.view_layer.objects.active
    if record_of(obj) is not None and obj.mode != "EDIT":
        renew_bands(obj)
