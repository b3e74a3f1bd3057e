"""The picture of a spectrum: strength over scale, the bands as alternating grounds."""

import bpy
import bpy.utils.previews
import numpy as np

from .records import SpectralTVRecord

WIDTH, HEIGHT = 256, 96
GROUNDS = ((0.16, 0.16, 0.16, 1.0), (0.21, 0.21, 0.21, 1.0))
LINE = (0.28, 0.45, 0.70, 1.0)

_previews: bpy.utils.previews.ImagePreviewCollection | None = None


def icon(record: SpectralTVRecord) -> int:
    """Icon of the picture, for UILayout.template_icon; drawn once per cut."""
    name = f"{record.identifier} {len(record.bands)}"
    if name not in _previews:
        _previews.clear()
        preview = _previews.new(name)
        preview.image_size = (WIDTH, WIDTH)
        preview.image_pixels_float = picture(record).ravel()
    return _previews[name].icon_id


def picture(record: SpectralTVRecord) -> np.ndarray:
    """The picture as (WIDTH, WIDTH, 4) RGBA from the bottom up, transparent around the plot.

    Components are spaced evenly, as the bands hold equal numbers of them.
    """
    strengths = np.array([sample.strength for sample in record.spectrum])
    times = np.array([sample.time for sample in record.spectrum])
    columns = np.minimum(np.arange(WIDTH) * len(times) // WIDTH, len(times) - 1)
    starts = np.array([band.start for band in record.bands])
    bands = np.searchsorted(starts, times, side="right") - 1
    plot = np.array(GROUNDS)[bands[columns] % 2][None].repeat(HEIGHT, axis=0)
    heights = strengths[columns] / max(strengths.max(), np.finfo(float).tiny) * (HEIGHT - 6)
    plot[np.arange(HEIGHT)[:, None] < heights] = LINE
    image = np.zeros((WIDTH, WIDTH, 4), dtype=np.float32)
    bottom = (WIDTH - HEIGHT) // 2
    image[bottom : bottom + HEIGHT] = plot
    return image


def register() -> None:
    """Make room for pictures."""
    global _previews  # noqa: PLW0603
    _previews = bpy.utils.previews.new()


def unregister() -> None:
    """Free the pictures."""
    bpy.utils.previews.remove(_previews)
