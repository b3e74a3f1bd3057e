"""Functions on a mesh: attributes, vertex groups and shape keys, read, flowed and written back."""

from . import outputs, properties

_PARTS = (outputs, properties)


def register() -> None:
    """Register the properties on meshes and scenes."""
    for part in _PARTS:
        part.register()


def unregister() -> None:
    """Unregister them; files keep what they hold."""
    for part in reversed(_PARTS):
        part.unregister()
