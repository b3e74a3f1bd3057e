"""Figure 5: two discs and two weighted sleeves on a torus."""

from __future__ import annotations

import numpy as np
import spectral_tv

from . import shapes
from .colors import colors
from .gallery import Gallery
from .page import plot

MINOR = 0.7


def make(gallery: Gallery) -> None:
    """Discs: the large one turns into a sleeve. Sleeves: both are gone at one moment."""
    shape = shapes.torus(minor=MINOR)
    mesh, points = shape.mesh, shape.vertices
    around = np.arctan2(points[:, 1], points[:, 0])
    small = np.linalg.norm(points - [-1.9, -1.9, 0], axis=1) < 0.5
    large = np.linalg.norm(points - [2.4, 0.0, 0.6], axis=1) < 1.45
    one = np.abs(np.angle(np.exp(1j * (around - np.pi / 2)))) < 0.85
    two = np.abs(np.angle(np.exp(1j * (around + np.pi / 2)))) < 0.4
    areas = [mesh.vertex_areas[part].sum() for part in (one, two)]
    rest = mesh.area - sum(areas)
    # The rest between them rises meanwhile, at the rate 2 per/rest, and meets both at one moment.
    rates = [1 / area + 2 / rest for area in areas]
    weight = rates[1] / rates[0]
    end = 1 / (4 * np.pi * MINOR * rates[0])
    rows = []
    for values, parts, last, shares in (
        (small + 1.0 * large, (large, small), 0.85, (0, 0.25, 0.55, 0.8)),
        (one + weight * two, (one, two), 1.1 * end, (0, 0.35, 0.7, 1)),
    ):
        times = np.linspace(0, last, 61)
        flow = spectral_tv.flow(mesh, values.astype(float), times, exact=True)
        states = [flow.states[round(60 * share)] for share in shares]
        shots = shape.painted([colors(state, 0, values.max()) for state in states])
        row = [(f"t = {last * share:.2f}", shot) for share, shot in zip(shares, shots, strict=True)]
        curves = [*(flow.mean(part) for part in parts), flow.mean(~(parts[0] | parts[1]))]
        rows.append([*row, ("mean values over time", plot(times, curves, 0, values.max()))])
    sheets = [("Two discs", rows[:1]), ("Two sleeves, weighted to vanish together", rows[1:])]
    gallery.save("torus_sets", sheets)
