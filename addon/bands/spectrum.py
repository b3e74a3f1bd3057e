"""The picture of a spectrum: strength over scale, in the colors and under the numbers of bands."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import bpy
import bpy.utils.previews
from spectral_tv.later import np

from ..drawing.ink import color, mask
from ..scene.decomposition import SpectralTVRecord

# Drawn at half that size where the interface is not scaled.
SIDE = 264
SWATCH = 32
GROUNDS = ((0.16, 0.16, 0.16, 1.0), (0.21, 0.21, 0.21, 1.0))
INK = (0.75, 0.75, 0.75, 1.0)
PIXEL = 4
# So many pictures are kept before they are drawn anew.
MOST_PICTURES = 64


@cache
def _previews() -> bpy.utils.previews.ImagePreviewCollection:
    return bpy.utils.previews.new()


def forget() -> None:
    """Free the pictures."""
    if _previews.cache_info().currsize:
        bpy.utils.previews.remove(_previews())
        _previews.cache_clear()


def icon(record: SpectralTVRecord) -> int:
    """The picture as an icon for UILayout.template_icon; drawn once per cut."""
    name = f"{record.identifier} {len(record.bands)}"
    return _icon(name, lambda: picture(record))


def swatch(band: int, count: int) -> int:
    """An icon in the color of a band, counted from 0."""
    name = f"band {band} of {count}"
    image = np.zeros((SWATCH, SWATCH, 4), dtype=np.float32)
    image[6:-6, 6:-6] = color(band, count)
    return _icon(name, lambda: image)


def picture(record: SpectralTVRecord) -> np.ndarray:
    """The picture as (SIDE, SIDE, 4) RGBA from the bottom up.

    Components are spaced evenly, as the bands hold equal numbers of them; the square root of
    their strength keeps fine detail visible beside large features.
    """
    times, strengths = record.kept_spectrum.T
    strengths = np.sqrt(strengths)
    starts = np.array([band.start for band in record.bands])
    edges = np.arange(len(times) + 1) * SIDE // len(times)
    band_of = np.clip(np.searchsorted(starts, times, side="right") - 1, 0, None)
    highest = max(strengths.max(), np.finfo(float).tiny)
    heights = (strengths / highest * (SIDE - 9 * PIXEL)).astype(int)
    image = np.empty((SIDE, SIDE, 4), dtype=np.float32)
    for left, right, band, height in zip(edges[:-1], edges[1:], band_of, heights, strict=True):
        image[:, left:right] = GROUNDS[band % 2]
        image[: max(height, 2), left : max(right - 2, left + 1)] = color(band, len(starts))
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


def _icon(name: str, draw: Callable[[], np.ndarray]) -> int:
    """The icon of a picture, drawn if it is not there."""
    previews = _previews()
    if name not in previews:
        if len(previews) > MOST_PICTURES:
            previews.clear()
        image, preview = draw(), previews.new(name)
        # Both, as template_icon shows the image and everything else the icon.
        preview.image_size = preview.icon_size = image.shape[1::-1]
        preview.image_pixels_float = preview.icon_pixels_float = image.ravel()
    return previews[name].icon_id
