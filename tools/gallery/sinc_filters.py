"""Figures 1 and 6: the height of the turned sinc curve filtered, as color and as shape."""

from __future__ import annotations

import numpy as np
import spectral_tv

from . import shapes
from .colors import colors
from .gallery import Gallery

TIMES = np.concatenate([np.linspace(0, 1.2, 31), np.geomspace(1.25, 20, 36)])
# Where parts have become planes, and where the upper two have become one.
PLANES, TWO = 0.7, 1.6
FILTERS = (
    ("f, all-pass", lambda t: 1),
    ("H1, low-pass: t > 0.7", lambda t: float(t > PLANES)),
    ("H2, low-pass: t > 1.6", lambda t: float(t > TWO)),
    ("H0, residual", lambda t: 0),
    ("H3, high-pass: t < 0.7", lambda t: float(t <= PLANES)),
)


def make(gallery: Gallery) -> None:
    """Show filtered heights as colors, and put them in the place of the height."""
    shape = shapes.sinc()
    height = shape.vertices[:, 2]
    flow = spectral_tv.flow(shape.mesh, height, TIMES, exact=True)
    filtered = [flow.filter(gain) for _, gain in FILTERS]
    # The front is cut away, so that what lies inside is seen.
    middles = shape.vertices[shape.triangles].mean(axis=1)
    back = shape.triangles[middles[:, 1] > -0.25 * np.abs(middles[:, 0])]
    cut = shapes.Shape(shape.vertices, back, azimuth=0, elevation=22)
    scale = height.min(), height.max()
    colored = shape.painted([colors(values, *scale) for values in filtered])
    lifted = cut.photograph(
        [
            (np.column_stack([shape.vertices[:, :2], values]), colors(values, *scale))
            for values in filtered
        ]
    )
    rows = [
        [(label, shot) for (label, _), shot in zip(FILTERS, colored, strict=True)],
        [("as the height, cut open", shot) for shot in lifted],
    ]
    gallery.save(
        "sinc_filters", [("The height of a surface of revolution, filtered by NETV", rows)]
    )
