"""Reading pictures from files: their own values, and what they mean."""

from pathlib import Path

import bpy
from spectral_tv.files.headers import Header
from spectral_tv.images.picture import Picture, header_of, in_steps, tell, turned_upright
from spectral_tv.images.pixels import Pixels
from spectral_tv.refusal import Refusal

from ..scene.temporary import Temporary
from . import colors
from .sources import refusal, stored_in


def read_picture(path: Path, space: str | None = None) -> Picture:
    """Read a picture; its colors are in the space of that name, or in that Blender assumes.

    What is in the file and is not kept is noted. Raises Refusal if it cannot be read, and OSError.
    """
    header = header_of(path)
    with Temporary() as now:
        image = now.made(bpy.data.images.load(str(path.absolute())))
        reason = refusal(image)
        if reason is not None:
            raise Refusal(reason)
        if header is None:
            header = _guessed(image)
        else:
            tell(path, header)
        if space in (None, "scene_linear"):  # the latter is a second name, in some versions
            space = colors.scene_linear() if space else image.colorspace_settings.name
        colors.make_raw(image)
        stored = stored_in(image)
    stored = in_steps(stored, header.depth)  # Blender's are rounded otherwise
    pixels = Pixels(stored, space, header.has_alpha, header.is_associated)
    return turned_upright(Picture(pixels, header))


def _guessed(image: bpy.types.Image) -> Header:
    """What Blender tells of a file whose header is not read here."""
    bits = image.depth // (4 if image.is_float else 1)
    return Header(
        format=image.file_format,
        depth="float" if image.is_float else "8",
        is_grey=bits == 8,
        has_alpha=bits == 32 and image.file_format != "HDR",
        is_associated=image.is_float and image.alpha_mode == "PREMUL",
        resolution=tuple(image.resolution) if image.file_format == "BMP" else None,
    )
