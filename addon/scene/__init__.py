"""What Blender holds: objects and their surfaces read, shape keys, records and results written."""

import bpy
from bpy.props import PointerProperty

from . import records, results

CLASSES = (*records.CLASSES, *results.CLASSES)
PROPERTIES = (
    (
        bpy.types.Key,
        "spectral_tv",
        PointerProperty(type=records.SpectralTVRecord, override={"LIBRARY_OVERRIDABLE"}),
    ),
    (bpy.types.Mesh, "spectral_tv", PointerProperty(type=results.SpectralTVMesh)),
)
