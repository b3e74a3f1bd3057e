"""Reading and writing picture files, by Pillow, pypng, tifffile and this package."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import png
import tifffile
from numpy.typing import NDArray
from PIL import Image

from spectral_tv.files import picture_tags
from spectral_tv.files.checks import check
from spectral_tv.files.headers import Header, read_header
from spectral_tv.files.srgb import encoded
from spectral_tv.images.encoding import (
    METRES_PER_INCH,
    SRGB,
    Target,
    channels_of,
    cut_off,
    ensure_same,
    integers,
    note_resolution,
    of_alpha,
    profile_for,
    rows_of,
    save_tiff,
)
from spectral_tv.images.formats import BY_SUFFIX, STEPS, Format
from spectral_tv.images.picture import Picture, header_of, tell, turned_upright
from spectral_tv.images.pixels import Pixels
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

# Color spaces by the names that Blender has for them.
LINEAR, DATA = "Linear Rec.709", "Non-Color"
SPACES = [SRGB, LINEAR, DATA]
# What is read, as headers call it.
READ = ("PNG", "JPEG", "TIFF", "WebP")
_PNG, _JPEG, _TIFF, _WEBP = (BY_SUFFIX[suffix] for suffix in (".png", ".jpg", ".tif", ".webp"))
# Unlike Blender's, these writers have grey with alpha in .png, and profiles and what is under alpha
# 0 in .webp.
_KINDS = (
    replace(_PNG, holds_grey_alpha=True),
    _JPEG,
    _TIFF,
    replace(_WEBP, holds_profile=True, loses_hidden=False),
)
FORMS: Mapping[str, Format] = {suffix: form for form in _KINDS for suffix in form.suffixes}
MODES = {"BW": "L", "BWA": "LA", "RGB": "RGB", "RGBA": "RGBA"}
LOSSLESS = 100


def read_picture(path: Path, space: str | None = None) -> Picture:
    """Read a picture; its colors are in the space of that name, or in what is usual for its depth.

    What is in the file and is not kept is noted. Raises Refusal if it cannot be read, and OSError.
    """
    header = header_of(path)
    if header is None or header.format not in READ:
        found = "" if header is None else f"it is a file of the format {header.format}; "
        raise Refusal(f"{found}pictures are read from files of the formats {', '.join(READ)}")
    tell(path, header)
    stored = _decoded(path, header)
    height, width, _ = stored.shape
    if min(height, width) < 2:
        raise Refusal(f"it has {width} × {height} pixels, but 2 × 2 are needed")
    assumed = SRGB if header.depth in STEPS else LINEAR
    pixels = Pixels(stored, space or assumed, header.has_alpha, header.is_associated)
    return turned_upright(Picture(pixels, header))


def save_picture(picture: Picture, path: Path, depth: str | None, quality: int | None) -> None:
    """Save a picture in the format of the path's suffix, and make sure of what was written.

    Linear colors of floats become sRGB in 8 and 16 bits. What cannot be kept is noted. Raises
    Refusal, Torn, RuntimeError if other values came out, and OSError.
    """
    target = Target.of(path, picture, depth, quality, FORMS)
    pixels = of_alpha(_of_space(picture, target), target, target.form.name != _JPEG.name)
    stored: NDArray[np.float32] = cut_off(pixels.stored, target).astype(np.float32)
    pixels = replace(pixels, stored=stored)
    channels = channels_of(picture, pixels, target)
    is_converted = pixels.space != picture.pixels.space
    profile = profile_for(picture, target, channels, is_converted)
    note_resolution(picture, target)
    rows = integers(rows_of(pixels, channels), target.depth)
    if target.form.name == _TIFF.name:
        save_tiff(picture, pixels, target, channels, profile)
    elif target.depth == "16":
        _write_png(path, rows, picture.header.resolution)
        if profile is not None:
            picture_tags.add_profile(path, profile)
    else:
        _write_by_pillow(target, rows, channels, picture.header.resolution, profile)
    check(path)
    header = read_header(path)
    if header is None:
        raise RuntimeError("it cannot be read again")
    ensure_same(_decoded(path, header), pixels, target)


def _of_space(picture: Picture, target: Target) -> Pixels:
    """The picture in a color space that the format holds by convention."""
    pixels = picture.pixels
    if not target.is_integer or picture.header.depth in STEPS or pixels.space != LINEAR:
        return pixels
    straight = pixels.associated(False)
    stored = straight.stored.copy()
    stored[..., :3] = encoded(stored[..., :3].astype(np.float64))
    note(f"its colors were converted from {LINEAR} to {SRGB}")
    return replace(straight, stored=stored, space=SRGB)


def _decoded(path: Path, header: Header) -> NDArray[np.float32]:
    """The values of a file, (H, W, 4) from the bottom up."""
    try:
        if header.format == "PNG" and header.depth == "16":
            rows = _rows_of_png(path)
        elif header.format == "TIFF":
            rows = _rows_of_tiff(path, header)
        else:
            rows = _rows_by_pillow(path, header)
    except (Refusal, MemoryError):
        raise
    except Exception as error:  # readers raise anything
        raise Refusal(f"it cannot be read: {str(error) or type(error).__name__}") from error
    values = rows.astype(np.float64)
    if rows.dtype.kind == "u":
        values /= np.iinfo(rows.dtype).max
    stored = np.ones((*rows.shape[:2], 4), dtype=np.float32)
    has_alpha = rows.shape[2] in (2, 4)
    stored[..., :3] = values[..., : rows.shape[2] - has_alpha]
    if has_alpha:
        stored[..., 3] = values[..., -1]
    return stored[::-1]


def _rows_by_pillow(path: Path, header: Header) -> NDArray[Any]:
    """Pixels of 8 bits, from the top down, (H, W, 3) or (H, W, 4)."""
    with Image.open(path) as image:
        return np.asarray(image.convert("RGBA" if header.has_alpha else "RGB"))


def _rows_of_png(path: Path) -> NDArray[Any]:
    """Pixels of 16 bits, from the top down, (H, W, C); Pillow would read 8 of them."""
    width, _, rows, about = png.Reader(filename=str(path)).asDirect()
    found = np.vstack([np.asarray(row, dtype=np.uint16) for row in rows])
    return found.reshape(-1, width, about["planes"])


def _rows_of_tiff(path: Path, header: Header) -> NDArray[Any]:
    """Pixels from the top down, (H, W, C)."""
    with tifffile.TiffFile(path) as file:
        page: Any = file.pages[0]
        is_plain = page.photometric in (tifffile.PHOTOMETRIC.MINISBLACK, tifffile.PHOTOMETRIC.RGB)
        if header.depth == "8" and not (is_plain and header.is_associated):
            return _rows_by_pillow(path, header)
        if not is_plain:
            raise Refusal(f"its colors of the kind {page.photometric.name} are read with 8 bits")
        try:
            rows = np.asarray(page.asarray())
        except ValueError as error:  # of a library that is not there
            raise Refusal(f"its compression is not read: {error}") from error
        if rows.ndim == 2:
            rows = rows[..., np.newaxis]
        elif page.axes.startswith("S"):  # planes, one after the other
            rows = np.moveaxis(rows, 0, -1)
    count = (1 if header.is_grey else 3) + header.has_alpha
    return rows[..., :count].astype(rows.dtype.newbyteorder("="))


def _write_png(
    path: Path, rows: NDArray[np.generic], resolution: tuple[float, float] | None
) -> None:
    """Write pixels of 16 bits, (H, W, C)."""
    height, width, channels = rows.shape
    more: dict[str, Any] = {}
    if resolution is not None:
        across, down = (round(each) for each in resolution)
        more = {"x_pixels_per_unit": across, "y_pixels_per_unit": down, "unit_is_meter": True}
    writer = png.Writer(
        width, height, greyscale=channels < 3, alpha=channels in (2, 4), bitdepth=16, **more
    )
    with path.open("wb") as file:
        writer.write(file, rows.reshape(height, -1))


def _write_by_pillow(
    target: Target,
    rows: NDArray[np.generic],
    channels: str,
    resolution: tuple[float, float] | None,
    profile: bytes | None,
) -> None:
    """Write pixels of 8 bits, (H, W, C)."""
    more: dict[str, Any] = {} if profile is None else {"icc_profile": profile}
    if resolution is not None and target.form.holds_resolution:
        more["dpi"] = tuple(each * METRES_PER_INCH for each in resolution)
    if target.form.name == _JPEG.name:
        more |= {"quality": target.quality, "subsampling": 0}
    elif target.form.name == _WEBP.name:
        is_lossless = target.quality == LOSSLESS
        more |= {"quality": target.quality, "lossless": is_lossless, "exact": True}
    flat = rows[..., 0] if rows.shape[2] == 1 else rows
    Image.fromarray(flat, MODES[channels]).save(target.path, target.form.name, **more)
