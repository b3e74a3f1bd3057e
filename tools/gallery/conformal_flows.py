"""Figure 10: conformalized P-Laplace flows for P = 1, 2, 3, and cMCF at constant area."""

from __future__ import annotations

import numpy as np
import spectral_tv

from .gallery import Gallery
from .page import Shape

# Moments by how much of the area is left, as the flows have no time in common.
LEFT = (1.0, 0.7, 0.45, 0.25, 0.1)
CELL = 150
ENDS = {1: 0.055, 2: 0.075, 3: 0.045}


def make(gallery: Gallery) -> None:
    """Show each flow when as much of the area is left."""
    for name, shape in gallery.subjects("armadillo", "michael0"):
        mesh, rows = shape.mesh, []
        for p in (3, 2, 1):
            times = spectral_tv.graded_times(1e-5 * mesh.area, ENDS[p] * mesh.area, 40)
            states = spectral_tv.decompose(mesh, "m2", times, p=p).flow.states
            chosen = _at_areas(shape, states)
            shots = shape.positions(chosen, CELL)
            rows.append(
                [(f"P = {p}, {area:.0%} left", s) for area, s in zip(LEFT, shots, strict=True)]
            )
            if p == 2:
                conformal = [
                    state / np.sqrt(area) for state, area in zip(chosen, LEFT, strict=True)
                ]
        rows.append([("cMCF, at constant area", shot) for shot in shape.positions(conformal, CELL)])
        gallery.save("conformal_flows", [("M2's flows", rows)], name, CELL)


def _at_areas(shape: Shape, states: np.ndarray) -> list[np.ndarray]:
    """The states whose areas are nearest to those shown."""
    area = shape.mesh.area
    areas = np.array([_area(state, shape.triangles) for state in states]) / area
    return [states[np.abs(areas - left).argmin()] for left in LEFT]


def _area(vertices: np.ndarray, triangles: np.ndarray) -> float:
    p, q, r = (vertices[corner] for corner in triangles.T)
    return float(np.linalg.norm(np.cross(q - p, r - p), axis=1).sum() / 2)
