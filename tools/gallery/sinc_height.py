"""Figure 20: the height on the turned sinc curve, by heat and by NETV."""

from __future__ import annotations

import numpy as np
import spectral_tv

from . import shapes
from .colors import colors
from .gallery import Gallery

TIMES = (0.0, 0.15, 0.45, 0.9, 2.4)


def make(gallery: Gallery) -> None:
    """Flow it by both."""
    shape = shapes.sinc()
    height = shape.vertices[:, 2]
    rows = []
    for label, options in (("Heat", {"operator": "heat"}), ("NETV", {"exact": True})):
        steps = np.linspace(0, TIMES[-1], 49)
        flow = spectral_tv.flow(shape.mesh, height, steps, **options)
        states = [flow.states[np.abs(steps - time).argmin()] for time in TIMES]
        shots = shape.painted([colors(state, height.min(), height.max()) for state in states])
        rows.append([(f"{label}, t = {t:g}", s) for t, s in zip(TIMES, shots, strict=True)])
    gallery.save("sinc_height", [("The height as a function on the surface", rows)])
