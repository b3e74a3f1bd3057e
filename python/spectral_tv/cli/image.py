"""``image``: pictures in, filtered pictures out."""

from pathlib import Path

from spectral_tv.cli.pictures import FORMS, READ, SPACES, read_picture, save_picture
from spectral_tv.files.whole import written
from spectral_tv.images.picture import Picture
from spectral_tv.images.verb import ImageVerb


class Filter(ImageVerb):
    """Splits pictures into bands, and filters them."""

    forms = FORMS
    source = f"a picture of the formats {', '.join(READ)}"
    assumed = "sRGB, and 'Linear Rec.709' of floats,"
    description = """\
Split pictures into bands by spectral total variation, filter them, and write them.

Works on the values of the file. Those of transparent pixels mean nothing and take no part. What is
written has the depth, the channels, the color profile and the resolution of the input, as far as
its format has them; 8 and 16 bits get sRGB where the input is linear floats."""
    examples = """\
  {program} image photo.jpg -o flat.png --gain 1=0 --gain 2=0
  {program} image *.png -o results --luminance --curve 0:0,0.5:1,1:2
  {program} image height.tif -o smooth.tif --colorspace Non-Color --gain 1=0"""

    def spaces(self) -> list[str]:
        """The color spaces that inputs can be in."""
        return SPACES

    def read(self, source: Path) -> Picture:
        """Read a picture; raises Refusal or OSError."""
        return read_picture(source, self.choices.colorspace)

    def save(self, picture: Picture, target: Path) -> None:
        """Save a picture; raises Refusal, RuntimeError or OSError."""
        with written(target) as path:
            save_picture(picture, path, self.choices.depth, self.choices.quality)
