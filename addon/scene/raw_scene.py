"""A scene for writing images whose values stay as they are."""

from collections.abc import Iterator
from contextlib import contextmanager

import bpy
from spectral_tv.refusal import Refusal

from .temporary import Temporary


@contextmanager
def raw_scene(file_format: str, depth: str | None) -> Iterator[bpy.types.Scene]:
    """A scene whose settings have Blender write values as they are, in a format of Blender's and
    with so many bits, if the format has a choice of them."""
    with Temporary() as now:
        scene = now.made(bpy.data.scenes.new("Picture"))
        scene.render.dither_intensity = 0
        settings = scene.render.image_settings
        settings.file_format = file_format
        if depth is not None:
            settings.color_depth = depth
        settings.color_management = "OVERRIDE"
        try:
            settings.view_settings.view_transform = "Raw"
        except TypeError as error:
            raise Refusal("the color management of this Blender has no view Raw") from error
        yield scene
