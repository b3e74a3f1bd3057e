"""Spectral TV: split a mesh into bands of detail that can be dialled, masked and animated."""

from . import operators


def register() -> None:
    """Called by Blender when the extension is enabled."""
    operators.register()


def unregister() -> None:
    """Called by Blender when the extension is disabled."""
    operators.unregister()
