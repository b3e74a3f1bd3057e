"""Reading pictures from files: their own values, and what they mean."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from spectral_tv.files.headers import Header, Torn, Unreadable, read_header
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

from ..scene.temporary import Temporary
from . import colors
from .formats import BY_SUFFIX, STEPS
from .pixels import Pixels
from .sources import refusal, stored_in

UPRIGHT, MIRRORED_ALONG_DIAGONAL = 1, 5


@dataclass(frozen=True)
class Picture:
    """A picture of a file, upright."""

    pixels: Pixels
    header: Header

    def told(self) -> dict[str, Any]:
        """What it is, for a report."""
        height, width, _ = self.pixels.stored.shape
        return {
            "format": self.header.format,
            "width": width,
            "height": height,
            "depth": self.header.depth,
            "channels": (1 if self.header.is_grey else 3) + self.header.has_alpha,
            "colorspace": self.pixels.space,
        }


def read_picture(path: Path, space: str | None = None) -> Picture:
    """Read a picture; its colors are in the space of that name, or in that Blender assumes.

    What is in the file and is not kept is noted. Raises Refusal if it cannot be read, and OSError.
    """
    try:
        header = read_header(path)
    except (Torn, Unreadable) as error:
        raise Refusal(str(error)) from error
    with Temporary() as now:
        image = now.made(bpy.data.images.load(str(path.absolute())))
        reason = refusal(image)
        if reason is not None:
            raise Refusal(reason)
        if header is None:
            header = _guessed(image)
        else:
            _tell(path, header)
        if space in (None, "scene_linear"):  # the latter is a second name, in some versions
            space = colors.scene_linear() if space else image.colorspace_settings.name
        colors.make_raw(image)
        stored = stored_in(image)
    if header.depth in STEPS:  # Blender's are rounded otherwise
        steps = STEPS[header.depth]
        stored = (np.rint(stored.astype(np.float64) * steps) / steps).astype(np.float32)
    pixels = Pixels(stored, space, header.has_alpha, header.is_associated)
    return _upright(Picture(pixels, header))


def upright(stored: np.ndarray, orientation: int) -> np.ndarray:
    """Turn an image (H, W, C), which is from the bottom up, as an EXIF orientation tells."""
    rows = stored[::-1]  # from the top down
    if orientation >= MIRRORED_ALONG_DIAGONAL:
        rows = rows.swapaxes(0, 1)
    if orientation in (2, 3, 6, 7):
        rows = rows[:, ::-1]
    if orientation in (3, 4, 7, 8):
        rows = rows[::-1]
    return np.ascontiguousarray(rows[::-1])


def _upright(picture: Picture) -> Picture:
    header = picture.header
    if header.orientation == UPRIGHT:
        return picture
    note("it was turned upright, as it says that it has to be")
    pixels = replace(picture.pixels, stored=upright(picture.pixels.stored, header.orientation))
    resolution = header.resolution
    if resolution is not None and header.orientation >= MIRRORED_ALONG_DIAGONAL:
        resolution = resolution[::-1]
    return Picture(pixels, replace(header, orientation=UPRIGHT, resolution=resolution))


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


def _tell(path: Path, header: Header) -> None:
    """Note what of a file is not kept."""
    form = BY_SUFFIX.get(path.suffix.lower())
    if form is None or form.name.replace("_", "") != header.format.upper():
        note(f"it is a file of the format {header.format}, whatever its name says")
    if header.unread:
        note(f"not kept: {', '.join(header.unread)}")
    for remark in header.remarks:
        note(remark)
