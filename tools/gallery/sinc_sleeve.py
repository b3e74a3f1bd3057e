"""Figure 3: the indicator of a sleeve on a turned sinc curve, by heat and by NETV."""

from __future__ import annotations

import numpy as np
import spectral_tv

from . import shapes
from .colors import colors
from .gallery import Gallery

TIMES = (0.0, 0.14, 0.28, 0.4, 0.5)


def make(gallery: Gallery) -> None:
    """Flow it by both, and show the same moments of each flow's own progress."""
    shape = shapes.sinc()
    height = shape.vertices[:, 2]
    sleeve = ((height > 0.36) & (height < 1.95)).astype(float)
    rows = []
    for label, options in (("Heat", {"operator": "heat"}), ("NETV", {"exact": True})):
        steps = np.linspace(0, TIMES[-1], 26)
        flow = spectral_tv.flow(shape.mesh, sleeve, steps, **options)
        states = [flow.states[np.abs(steps - time).argmin()] for time in TIMES]
        shots = shape.painted([colors(state, 0, 1) for state in states])
        rows.append([(f"{label}, t = {t:g}", s) for t, s in zip(TIMES, shots, strict=True)])
    gallery.save("sinc_sleeve", [("An indicator function on a surface of revolution", rows)])
