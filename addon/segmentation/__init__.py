"""Parts: found alike in several poses, and written on them."""

import bpy
from bpy.props import PointerProperty

from . import cosegment, panel, properties

CLASSES = (*properties.CLASSES, *cosegment.CLASSES, *panel.CLASSES)
PROPERTIES = (
    (
        bpy.types.Scene,
        "spectral_tv_segmentation",
        PointerProperty(type=properties.SpectralTVSegmentation),
    ),
)
