"""The mask of a new band in the place of old ones whose masks differ.

The filter over scales is another one at each vertex there: the value times the mask. So the value
of the new band times its mask is the mean of these, as its value is the mean of the values.
"""

from __future__ import annotations

from collections.abc import Sequence

import bpy
from spectral_tv.later import np

from ..scene.keeping import Band
from ..scene.mix import mask


def mean_mask(
    obj: bpy.types.Object, bands: Sequence[Band], parts: Sequence[float], values: Sequence[float]
) -> np.ndarray:
    """The weights (V,) for a band that is made of ``parts`` of others, which have ``values``.

    Where all values are 0, or of both signs so that some of it would be beyond 0 and 1, the bands
    count by their parts and how far they act.
    """
    masks = [mask(obj, band) for band in bands]
    counts = np.multiply(parts, values)
    if np.abs(counts).max(initial=0.0) == 0:
        counts = np.array(parts, dtype=np.float64)
    if (counts > 0).any() and (counts < 0).any():
        counts = np.abs(counts)
    return np.clip(np.tensordot(counts / counts.sum(), masks, axes=1), 0, 1)
