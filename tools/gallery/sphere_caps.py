"""Figure 4: a cap of the sphere and its complement fade in straight lines."""

from __future__ import annotations

import numpy as np
import spectral_tv

from . import shapes
from .colors import colors
from .gallery import Gallery
from .page import plot

ANGLE = 1.0


def make(gallery: Gallery) -> None:
    """Flow both indicator functions exactly; curves are values inside and outside the set."""
    shape = shapes.sphere()
    cap = shape.vertices[:, 2] > np.cos(ANGLE)
    end = 0.42
    times = np.linspace(0, end, 43)
    rows = []
    for label, members in (("Complement", ~cap), ("Cap", cap)):
        flow = spectral_tv.flow(shape.mesh, members.astype(float), times, exact=True)
        states = [flow.states[int(share * 42)] for share in (0, 0.45, 0.9)]
        shots = shape.painted([colors(state, 0, 1) for state in states])
        curves = [flow.mean(members), flow.mean(~members)]
        area, perimeter = 2 * np.pi * (1 - np.cos(ANGLE)), 2 * np.pi * np.sin(ANGLE)
        area = area if label == "Cap" else 4 * np.pi - area
        rate = -np.polyfit(times[:30], curves[0][:30], 1)[0]
        row = [
            (f"{label}, t = {end * share:.2f}", shot)
            for share, shot in zip((0, 0.45, 0.9), shots, strict=True)
        ]
        rows.append(
            [*row, (f"rate {rate:.2f}, per/area {perimeter / area:.2f}", plot(times, curves, 0, 1))]
        )
    gallery.save("sphere_caps", [("Two eigensets of the sphere, and their values over time", rows)])
