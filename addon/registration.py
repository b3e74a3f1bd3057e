"""Registering what the features declare in their ``__init__.py``.

CLASSES are Blender's classes, in order. PROPERTIES are properties of Blender's own types: the type,
a name, and the property. VERBS are those of the command line. What FORGET names is called when
Blender loads a file, and in the end; what WITHDRAW names, in the end.
"""

from itertools import chain
from types import ModuleType

import bpy
from bpy.app.handlers import persistent

from . import attributes, bands, command_line, deformation, images, job, scene, segmentation

# What others build on comes first.
_PARTS: tuple[ModuleType, ...] = (
    scene, job, bands, deformation, segmentation, attributes, images
)  # fmt: skip


def _all(name: str) -> list:
    return list(chain.from_iterable(getattr(part, name, ()) for part in _PARTS))


@persistent
def _forget(*_arguments: object) -> None:
    for forget in _all("FORGET"):
        forget()


def register() -> None:
    """Register all of it, and listen for files being loaded."""
    for part in _PARTS:
        for cls in part.CLASSES:
            bpy.utils.register_class(cls)
        for owner, name, declared in getattr(part, "PROPERTIES", ()):
            setattr(owner, name, declared)
    bpy.app.handlers.load_pre.append(_forget)
    command_line.register(_all("VERBS"))


def unregister() -> None:
    """End what still runs, and withdraw all; files keep what they hold."""
    command_line.unregister()
    bpy.app.handlers.load_pre.remove(_forget)
    _forget()
    for withdraw in _all("WITHDRAW"):
        withdraw()
    for owner, name, _ in reversed(_all("PROPERTIES")):
        delattr(owner, name)
    for cls in reversed(_all("CLASSES")):
        bpy.utils.unregister_class(cls)
