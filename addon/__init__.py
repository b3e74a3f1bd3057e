"""Spectral TV: split a mesh into bands of detail that can be dialled, masked and animated.

Each feature has a folder with its options, operators, panels and verb of the command line. Features
use the package spectral_tv. If it cannot be used, nothing is registered but a panel that says why,
and a command that says the same.
"""

import gc
from importlib import import_module
from types import ModuleType

from . import native

_registered: ModuleType | None = None


def register() -> None:
    """Called by Blender when the extension is enabled."""
    global _registered  # noqa: PLW0603 - it lives as long as the module
    collects = gc.isenabled()
    gc.disable()  # of what is read here nothing is garbage, and to look through it takes time
    try:
        name = "registration" if native.problem() is None else "unavailable"
        part = import_module(f".{name}", __package__)
        part.register()
    finally:
        if collects:
            gc.enable()
    _registered = part


def unregister() -> None:
    """Called by Blender when the extension is disabled."""
    global _registered  # noqa: PLW0603 - it lives as long as the module
    if _registered is not None:
        _registered.unregister()
    _registered = None
