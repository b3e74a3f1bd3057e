"""Figure 14: the length of a TV displacement is constant on sets that fade in straight lines."""

from __future__ import annotations

import numpy as np
import spectral_tv

from .colors import colors
from .gallery import Gallery
from .page import plot
from .pulls import pulls


def make(gallery: Gallery) -> None:
    """Flow the length of the displacement, and tell the means of what moves and what stays."""
    for name, shape, indices, targets in pulls(gallery):
        mesh = shape.mesh
        found = spectral_tv.deform(mesh, indices, targets)
        length = np.linalg.norm(found.vertices - shape.vertices, axis=1)
        moved = length > length.max() / 2
        # Where they would meet at the rates perimeter/area of both.
        sets = spectral_tv.eigenset_test(mesh, moved)
        rest = mesh.area - sets.area
        end = length.max() / (sets.perimeter * (1 / sets.area + 1 / rest))
        times = np.linspace(0, 1.15 * end, 31)
        flow = spectral_tv.flow(mesh, length, times, exact=True)
        moments = (0, 0.35, 0.75)
        states = [flow.states[round(30 * share)] for share in moments]
        shots = shape.painted([colors(state, 0, length.max()) for state in states], cell=190)
        curves = [flow.mean(moved), flow.mean(~moved)]
        row = [
            (f"|d|, t = {times[-1] * m:.2g}", shot) for m, shot in zip(moments, shots, strict=True)
        ]
        label = "rest and moved part over time"
        row.append((label, plot(times, curves, 0, length.max(), 190)))
        gallery.save(
            "displacement", [("The length of the displacement under NETV", [row])], name, 190
        )
