"""Figures 2 and 7: the function that M3 flows, in color, and the shapes that its filters give."""

from __future__ import annotations

import numpy as np
import spectral_tv

from .colors import colors
from .gallery import Gallery

# How far the base is smoothed, and moments, as t/area.
BASE = 4e-4
TIMES = (0.0, 2e-5, 8e-5, 4e-4)


def make(gallery: Gallery) -> None:
    """The displacement from the base under NETV, and three filters."""
    for name, shape in gallery.subjects("igea", "armadillo"):
        mesh = shape.mesh
        split = spectral_tv.decompose(mesh, "m3", steps=40, base_time=BASE * mesh.area)
        states = split.flow.states
        low, high = np.quantile(states[0], [0.03, 0.97])
        moments = [np.abs(split.times - t * mesh.area).argmin() for t in TIMES]
        colored = shape.painted([colors(states[k], low, high) for k in moments], cell=190)
        bands = split.bands(split.band_edges(4))
        versions = (
            ("Original", shape.vertices),
            ("Low-pass", shape.vertices - bands[:2].sum(axis=0)),
            ("Fine detail × 2.5", shape.vertices + 1.5 * bands[:2].sum(axis=0)),
            ("Coarse detail × 2", shape.vertices + bands[2:].sum(axis=0)),
        )
        shots = shape.positions([positions for _, positions in versions], cell=190)
        rows = [
            [(f"f at t = {t:g} area", shot) for t, shot in zip(TIMES, colored, strict=True)],
            [(label, shot) for (label, _), shot in zip(versions, shots, strict=True)],
        ]
        gallery.save("perturbation", [("Distance from a smooth base", rows)], name, cell=190)
