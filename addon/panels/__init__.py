"""The sidebar tab; a new panel is a file and a line here."""

import bpy

from . import attributes, bands, caricature, decompose, deform, image, segment

_FILES = (decompose, bands, deform, caricature, segment, attributes, image)

register, unregister = bpy.utils.register_classes_factory(
    [cls for file in _FILES for cls in file.CLASSES]
)
