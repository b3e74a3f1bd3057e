"""The picture of a spectrum: strength over scale, the bands as alternating grounds."""

import bpy
import bpy.utils.previews
import numpy as np

from .records import SpectralTVRecord

# Icons are square, so a wide picture is a row of them.
TILES = 3
SIDE = 96
GROUNDS = ((0.16, 0.16, 0.16, 1.0), (0.22, 0.22, 0.22, 1.0))
BARS = (0.28, 0.45, 0.70, 1.0)

_previews: bpy.utils.previews.ImagePreviewCollection | None = None


def icons(record: SpectralTVRecord) -> list[int]:
    """Icons of the picture from left to right, for UILayout.template_icon; drawn once per cut."""
    names = [f"{record.identifier} {len(record.bands)} {tile}" for tile in range(TILES)]
    if names[0] not in _previews:
        _previews.clear()
        for name, tile in zip(names, np.split(picture(record), TILES, axis=1), strict=True):
            preview = _previews.new(name)
            preview.image_size = (SIDE, SIDE)
            preview.image_pixels_float = tile.ravel()
    return [_previews[name].icon_id for name in names]


def picture(record: SpectralTVRecord) -> np.ndarray:
    """The picture as (SIDE, TILES * SIDE, 4) RGBA from the bottom up.

    Components are spaced evenly, as the bands hold equal numbers of them; the square root of
    their strength keeps fine detail visible beside large features.
    """
    strengths = np.sqrt([sample.strength for sample in record.spectrum])
    times = np.array([sample.time for sample in record.spectrum])
    width = TILES * SIDE
    columns = np.arange(width) * len(times) // width
    starts = np.array([band.start for band in record.bands])
    bands = np.searchsorted(starts, times, side="right") - 1
    image = np.array(GROUNDS, dtype=np.float32)[bands[columns] % 2][None].repeat(SIDE, axis=0)
    heights = strengths[columns] / max(strengths.max(), np.finfo(float).tiny) * 0.94 * SIDE
    image[np.arange(SIDE)[:, None] < heights] = BARS
    return image


def register() -> None:
    """Make room for pictures."""
    global _previews  # noqa: PLW0603
    _previews = bpy.utils.previews.new()


def unregister() -> None:
    """Free the pictures."""
    bpy.utils.previews.remove(_previews)
