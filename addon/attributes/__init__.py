"""Functions on a mesh: attributes, vertex groups and shape keys, read, flowed and written back."""

import bpy
from bpy.props import PointerProperty

from . import accuracy_panel, eigenset, flow, measure_accuracy, panel, properties, values

_FILES = (properties, flow, values, eigenset, measure_accuracy, panel, accuracy_panel)
CLASSES = tuple(cls for file in _FILES for cls in file.CLASSES)
PROPERTIES = (
    (
        bpy.types.Scene,
        "spectral_tv_attributes",
        PointerProperty(type=properties.SpectralTVAttributes),
    ),
)
