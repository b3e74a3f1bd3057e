"""What Blender holds: objects and their surfaces read, shape keys, records and results written."""

import bpy
from bpy.props import PointerProperty

from . import records, results

CLASSES = (*records.CLASSES, *results.CLASSES)
PROPERTIES = (
    # Of 0.1.0; today a mark of the block, see keeping.
    (
        bpy.types.Key,
        "spectral_tv",
        PointerProperty(type=records.SpectralTVRecord, override={"LIBRARY_OVERRIDABLE"}),
    ),
    (
        bpy.types.Mesh,
        "spectral_tv",
        PointerProperty(type=results.SpectralTVMesh, override={"LIBRARY_OVERRIDABLE"}),
    ),
)
