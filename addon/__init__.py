"""Spectral TV: split a mesh into bands of detail that can be dialled, masked and animated.

Panels call operators, operators run jobs, jobs call the package spectral_tv. Where that package
cannot be used, a panel that says so takes the place of all parts.
"""

from importlib import import_module
from types import ModuleType

from . import native

_PARTS = (
    "decomposition.properties",
    "scene.records",
    "scene.results",
    "deformation.constraints",
    "attributes",
    "images",
    "decomposition.spectrum",
    "operators",
    "panels",
    "handlers",
    "command_line",
)
_registered: list[ModuleType] = []


def register() -> None:
    """Called by Blender when the extension is enabled."""
    for name in _PARTS if native.problem() is None else ("unavailable",):
        part = import_module(f".{name}", __package__)
        part.register()
        _registered.append(part)


def unregister() -> None:
    """Called by Blender when the extension is disabled."""
    while _registered:
        _registered.pop().unregister()
