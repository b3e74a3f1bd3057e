"""A picture of a file: its values, and what the file says of them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spectral_tv.dataclass import dataclass
from spectral_tv.files.headers import Header, Torn, Unreadable, read_header
from spectral_tv.images.formats import BY_SUFFIX, STEPS
from spectral_tv.images.pixels import Pixels
from spectral_tv.later import np
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

if TYPE_CHECKING:
    from numpy.typing import NDArray

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


def in_steps(stored: NDArray[np.float32], depth: str) -> NDArray[np.float32]:
    """The values of integers in files, of values that were rounded on the way."""
    if depth not in STEPS:
        return stored
    steps = STEPS[depth]
    return (np.rint(stored.astype(np.float64) * steps) / steps).astype(np.float32)


def upright(stored: NDArray[np.float32], orientation: int) -> NDArray[np.float32]:
    """Turn an image (H, W, C), which is from the bottom up, as an EXIF orientation tells."""
    rows = stored[::-1]  # from the top down
    if orientation >= MIRRORED_ALONG_DIAGONAL:
        rows = rows.swapaxes(0, 1)
    if orientation in (2, 3, 6, 7):
        rows = rows[:, ::-1]
    if orientation in (3, 4, 7, 8):
        rows = rows[::-1]
    return np.ascontiguousarray(rows[::-1])


def turned_upright(picture: Picture) -> Picture:
    """The picture as it has to be seen; notes it if it was turned."""
    header = picture.header
    if header.orientation == UPRIGHT:
        return picture
    note("it was turned upright, as it says that it has to be")
    pixels = replace(picture.pixels, stored=upright(picture.pixels.stored, header.orientation))
    resolution = header.resolution
    if resolution is not None and header.orientation >= MIRRORED_ALONG_DIAGONAL:
        resolution = resolution[::-1]
    return Picture(pixels, replace(header, orientation=UPRIGHT, resolution=resolution))


def header_of(path: Path) -> Header | None:
    """What a file says of its picture, None if its format is not known here.

    Raises Refusal if it is cut short or says nothing that can be read, and OSError.
    """
    try:
        return read_header(path)
    except (Torn, Unreadable) as error:
        raise Refusal(str(error)) from error


def tell(path: Path, header: Header) -> None:
    """Note what of a file is not kept."""
    form = BY_SUFFIX.get(path.suffix.lower())
    if form is None or form.name.replace("_", "") != header.format.upper():
        note(f"it is a file of the format {header.format}, whatever its name says")
    if header.unread:
        note(f"not kept: {', '.join(header.unread)}")
    for remark in header.remarks:
        note(remark)
