"""Spectral TV: split a mesh into bands of detail that can be dialled, masked and animated.

Panels call operators, operators run jobs, jobs call the package spectral_tv.
"""

from . import (
    attributes,
    command_line,
    constraints,
    handlers,
    images,
    operators,
    panels,
    properties,
    records,
    spectrum,
)

_PARTS = (
    properties,
    records,
    constraints,
    attributes,
    images,
    spectrum,
    operators,
    panels,
    handlers,
    command_line,
)


def register() -> None:
    """Called by Blender when the extension is enabled."""
    for part in _PARTS:
        part.register()


def unregister() -> None:
    """Called by Blender when the extension is disabled."""
    for part in reversed(_PARTS):
        part.unregister()
