"""The verb that filters images: pictures in, pictures out."""

from pathlib import Path

import bpy
from spectral_tv.files.room import with_room
from spectral_tv.images.formats import BY_SUFFIX
from spectral_tv.images.picture import Picture
from spectral_tv.images.verb import ImageVerb

from ..command_line.writing import written_by_blender
from . import colors
from .reading import read_picture
from .saving import save_picture

# What a pixel takes at most, and a picture beside its pixels, bytes.
PIXEL, REST = 16, 1 << 20


class Filter(ImageVerb):
    """Splits pictures into bands, and filters them."""

    forms = BY_SUFFIX
    source = "a picture that Blender reads"
    assumed = "what Blender assumes"
    description = """\
Split pictures into bands by spectral total variation, filter them, and write them.

Works on the values of the file: encoded for displays in most formats, scene-linear in .exr. Those
of transparent pixels mean nothing and take no part. What is written has the depth, the channels and
the color space of the input, as far as its format has them; only .exr gets scene-linear colors, and
8 and 16 bits get sRGB where the input is linear floats."""
    examples = """\
  {program} image photo.jpg -o flat.png --gain 1=0 --gain 2=0
  {program} image *.png -o results --luminance --curve 0:0,0.5:1,1:2
  {program} image height.tif -o smooth.exr --colorspace Non-Color --gain 1=0"""

    def spaces(self) -> list[str]:
        return colors.names()

    def read(self, source: Path) -> Picture:
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        return read_picture(source, self.choices.colorspace)

    def save(self, picture: Picture, target: Path) -> None:
        # A disk that gets full would end the process when Blender reads what it has written.
        most = REST + PIXEL * picture.pixels.stored[..., 0].size
        with written_by_blender(target) as path, with_room(path, most) as place:
            save_picture(picture, place, self.choices.depth, self.choices.quality)
