"""Images: their pixels read, split into bands, filtered, and written as new images."""

import bpy
from bpy.props import PointerProperty

from . import operator, panel, properties, verb

CLASSES = (*properties.CLASSES, *operator.CLASSES, *panel.CLASSES)
PROPERTIES = (
    (bpy.types.Scene, "spectral_tv_images", PointerProperty(type=properties.SpectralTVImages)),
    (bpy.types.Image, "spectral_tv", PointerProperty(type=properties.SpectralTVImage)),
)
VERBS = (verb.Filter(),)
