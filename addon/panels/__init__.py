"""The sidebar tab; a new panel is a file and a line here."""

import bpy

from . import bands, decompose

register, unregister = bpy.utils.register_classes_factory((*decompose.CLASSES, *bands.CLASSES))
