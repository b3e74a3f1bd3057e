"""The picture of a spectrum: strength over scale, in the colours and under the numbers of bands."""

import colorsys

import bpy
import bpy.utils.previews
import numpy as np

from ..scene.records import SpectralTVRecord
from .lettering import mask

# Drawn at half that size where the interface is not scaled.
SIDE = 264
SWATCH = 32
GROUNDS = ((0.16, 0.16, 0.16, 1.0), (0.21, 0.21, 0.21, 1.0))
INK = (0.75, 0.75, 0.75, 1.0)
PIXEL = 4
# Hues of the finest and the largest band.
HUES = (0.57, 0.06)
# So many pictures are kept before they are drawn anew.
MOST_PICTURES = 64

_previews: bpy.utils.previews.ImagePreviewCollection | None = None


def icon(record: SpectralTVRecord) -> int:
    """The picture as an icon for UILayout.template_icon; drawn once per cut."""
    name = f"{record.identifier} {len(record.bands)}"
    if name not in _previews:
        if len(_previews) > MOST_PICTURES:
            _previews.clear()
        _add(name, picture(record))
    return _previews[name].icon_id


def swatch(band: int, count: int) -> int:
    """An icon in the colour of a band, counted from 0."""
    name = f"band {band} of {count}"
    if name not in _previews:
        image = np.zeros((SWATCH, SWATCH, 4), dtype=np.float32)
        image[6:-6, 6:-6] = colour(band, count)
        _add(name, image)
    return _previews[name].icon_id


def colour(band: int, count: int) -> tuple[float, ...]:
    """RGBA of a band."""
    position = band / max(count - 1, 1)
    hue = HUES[0] + (HUES[1] - HUES[0]) * position
    return (*colorsys.hsv_to_rgb(hue, 0.6, 0.8), 1.0)


def picture(record: SpectralTVRecord) -> np.ndarray:
    """The picture as (SIDE, SIDE, 4) RGBA from the bottom up.

    Components are spaced evenly, as the bands hold equal numbers of them; the square root of
    their strength keeps fine detail visible beside large features.
    """
    strengths = np.sqrt([sample.strength for sample in record.spectrum])
    times = np.array([sample.time for sample in record.spectrum])
    starts = np.array([band.start for band in record.bands])
    edges = np.arange(len(times) + 1) * SIDE // len(times)
    band_of = np.clip(np.searchsorted(starts, times, side="right") - 1, 0, None)
    highest = max(strengths.max(), np.finfo(float).tiny)
    heights = (strengths / highest * (SIDE - 9 * PIXEL)).astype(int)
    image = np.empty((SIDE, SIDE, 4), dtype=np.float32)
    for left, right, band, height in zip(edges[:-1], edges[1:], band_of, heights, strict=True):
        image[:, left:right] = GROUNDS[band % 2]
        image[: max(height, 2), left : max(right - 2, left + 1)] = colour(band, len(starts))
    for band in range(len(starts)):
        members = np.flatnonzero(band_of == band)
        if len(members) > 0:
            _write(image, str(band + 1), edges[members[0]], edges[members[-1] + 1])
    return image


def _write(image: np.ndarray, text: str, left: int, right: int) -> None:
    """Write a number at the top between two columns, if there is room for it."""
    ink = mask(text, PIXEL)
    width = ink.shape[1]
    if right - left < width + PIXEL:
        return
    x = (left + right - width) // 2
    image[-7 * PIXEL : -2 * PIXEL, x : x + width][ink] = INK


def _add(name: str, image: np.ndarray) -> None:
    preview = _previews.new(name)
    # Both, as template_icon shows the image and everything else the icon.
    preview.image_size = preview.icon_size = image.shape[1::-1]
    preview.image_pixels_float = preview.icon_pixels_float = image.ravel()


def register() -> None:
    """Make room for pictures."""
    global _previews  # noqa: PLW0603 - it lives as long as the module
    _previews = bpy.utils.previews.new()


def unregister() -> None:
    """Free the pictures."""
    bpy.utils.previews.remove(_previews)
