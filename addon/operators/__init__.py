"""The operators under bpy.ops.spectral_tv; a new one is a class in a file's CLASSES."""

import bpy

from . import _job, decompose, filter

register, unregister = bpy.utils.register_classes_factory(
    (*_job.CLASSES, *decompose.CLASSES, *filter.CLASSES)
)
