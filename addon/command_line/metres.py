"""Writing scenes in other units than metres, in metres if the format has a unit."""

from collections.abc import Iterator
from contextlib import contextmanager

import bpy
from mathutils import Matrix
from spectral_tv.notes import a, note
from spectral_tv.refusal import Refusal

from ..scene.temporary import Temporary
from .formats import FORMATS, has_option

# Formats that know no unit; .dae tells its own, and the exporter of .fbx converts.
UNITLESS = (".abc", ".obj", ".ply", ".stl")
NAME = "Metres"


def metres_per_unit() -> float:
    """The metres of a unit of the scene."""
    settings = bpy.context.scene.unit_settings
    # A float of 32 bits, as a user wrote it.
    return 1.0 if settings.system == "NONE" else float(f"{settings.scale_length:.6g}")


def tell_units(suffix: str) -> None:
    """Note what becomes of the units of the scene in a file of this suffix."""
    metres = metres_per_unit()
    if metres == 1:
        return
    if suffix in UNITLESS:
        note(f"{a(suffix)} knows no unit: its numbers are in units of {metres:g} m, as the scene's")
    elif suffix == ".fbx":
        note(f"converted to metres, from units of {metres:g} m")
    elif _needs_parent(suffix):
        note(f"converted to metres, from units of {metres:g} m, by a parent of all, {NAME!r}")


@contextmanager
def in_metres(suffix: str) -> Iterator[None]:
    """Have all objects be in metres, where the exporter takes the scene's units for that.

    An object that all others are children of scales them, so that animation stays as it is.
    Raises Refusal if one cannot be changed.
    """
    if metres_per_unit() == 1 or not _needs_parent(suffix):
        yield
        return
    scene = bpy.context.scene
    roots = [obj for obj in scene.objects if obj.parent is None]
    linked = [obj.name for obj in roots if obj.library is not None]
    if linked:
        raise Refusal(f"{linked[0]} is linked from another file, so it cannot be put into metres")
    with Temporary() as now:
        now.callback(bpy.context.view_layer.update)
        parent = now.made(bpy.data.objects.new(NAME, None))
        scene.collection.objects.link(parent)
        parent.scale = [metres_per_unit()] * 3
        parent.select_set(True)
        for obj in roots:
            now.adopt(obj, parent, Matrix())
        bpy.context.view_layer.update()
        yield


def _needs_parent(suffix: str) -> bool:
    """Whether the exporter writes the scene's units as if they were metres."""
    if suffix in (".glb", ".gltf"):
        return True
    # Older exporters tell the scene's units.
    return suffix.startswith(".usd") and has_option(FORMATS[suffix].exporter, "convert_scene_units")
