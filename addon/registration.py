"""Registering the classes, properties and verbs of the features.

A feature's ``__init__.py`` has names alone, so that no file is read before it is needed. FILES has,
in order, those of the files that have classes of Blender, and that are told of changes by a list of
another file, which they are added to when they are read. A property group with an ``owner``, a type
of Blender's and a name, becomes a property of that type. VERBS has the feature's verbs of the
command line, classes of its file ``verb``, which is read when a command line runs: windows start
without. The others have functions, each after its file. Those of START are called when the
extension is enabled, and those of LOADED then too, and when Blender has loaded, linked or appended
from a file. Those of FORGET are called when Blender loads a file and when the extension is
disabled, and those of WITHDRAW in the latter case alone; files that were never read hold nothing.
"""

import sys
from collections.abc import Iterator
from importlib import import_module
from operator import attrgetter
from types import ModuleType

import bpy
from bpy.app.handlers import persistent
from bpy.types import AddonPreferences, Menu, Operator, Panel, PropertyGroup, UIList

from . import (
    attributes,
    bands,
    command_line,
    deformation,
    deviation,
    drawing,
    images,
    job,
    maps,
    recipes,
    scene,
    segmentation,
)
from .drawing import preferences

# What others build on comes first, and of the panels those of the recipes.
_PARTS: tuple[ModuleType, ...] = (
    scene, drawing, job, recipes, bands, deviation, maps, deformation, segmentation, attributes,
    images
)  # fmt: skip
_KINDS = Operator | Panel | Menu | PropertyGroup | UIList | AddonPreferences


def _verbs() -> list[command_line.Named]:
    return [
        (f"{part.__name__}.verb", name) for part in _PARTS for name in getattr(part, "VERBS", ())
    ]


def _named(table: str) -> Iterator[tuple[str, str]]:
    """The module of each name in a table of the features, and what of it is meant."""
    for part in _PARTS:
        for name in getattr(part, table, ()):
            file, _, meant = name.partition(".")
            yield f"{part.__name__}.{file}", meant


def _call_all(table: str) -> None:
    for module, function in _named(table):
        attrgetter(function)(import_module(module))()


def _end_all(table: str) -> None:
    for module, function in _named(table):
        if module in sys.modules:
            attrgetter(function)(sys.modules[module])()


def _classes() -> Iterator[type]:
    """Blender's classes, in the order in which the files have them."""
    for module, _ in _named("FILES"):
        for each in vars(import_module(module)).values():
            is_own = isinstance(each, type) and each.__module__ == module
            if is_own and issubclass(each, _KINDS):
                yield each


@persistent
def _forget(*_arguments: object) -> None:
    _end_all("FORGET")


@persistent
def _loaded(*_arguments: object) -> None:
    _call_all("LOADED")


def _loading_handlers() -> list[list]:
    """Blender's lists of what is called after files were loaded; 4.2 has none for linking."""
    names = ("load_post", "blend_import_post")
    return [getattr(bpy.app.handlers, name) for name in names if hasattr(bpy.app.handlers, name)]


def _panels() -> list[type[Panel]]:
    return [cls for cls in _classes() if issubclass(cls, Panel)]


def _move_panels() -> None:
    """Have the panels be in the tab of the preferences."""
    for cls in reversed(_panels()):
        bpy.utils.unregister_class(cls)
    for cls in _panels():
        _register(cls)


def _register(cls: type) -> None:
    if issubclass(cls, Panel):
        cls.bl_category = preferences.tab()
    bpy.utils.register_class(cls)


def register() -> None:
    """Register all of it, and listen for files being loaded."""
    for cls in _classes():
        _register(cls)
        if hasattr(cls, "owner"):
            owner, name, *override = cls.owner
            setattr(owner, name, bpy.props.PointerProperty(type=cls, override=set(override)))
    bpy.app.handlers.load_pre.append(_forget)
    for handlers in _loading_handlers():
        handlers.append(_loaded)
    if hasattr(bpy.data, "objects"):  # not yet while Blender starts
        _loaded()
    command_line.register(_verbs())
    preferences.RENAMED.append(_move_panels)
    _call_all("START")


def unregister() -> None:
    """End what still runs, and withdraw all; files keep what they hold."""
    command_line.unregister()
    preferences.RENAMED.remove(_move_panels)
    bpy.app.handlers.load_pre.remove(_forget)
    for handlers in _loading_handlers():
        handlers.remove(_loaded)
    _forget()
    _end_all("WITHDRAW")
    for cls in reversed([*_classes()]):
        if hasattr(cls, "owner"):
            delattr(*cls.owner[:2])
        bpy.utils.unregister_class(cls)
