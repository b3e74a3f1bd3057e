"""The parts that are held and pulled in the figures of deformations."""

from __future__ import annotations

import numpy as np

from .gallery import Gallery
from .page import Shape

Pull = tuple[str, Shape, np.ndarray, np.ndarray]


def pulls(gallery: Gallery) -> list[Pull]:
    """Subjects, each with the vertices that are constrained and their targets."""
    found = []
    for name, shape in gallery.subjects("cheburashka", "armadillo"):
        points = shape.vertices
        x, _, z = ((points - points.min(axis=0)) / np.ptp(points, axis=0)).T
        size = shape.mesh.area**0.5
        if name == "armadillo":
            held, pulled, offset = z < 0.05, (x > 0.93) & (z > 0.6), (0.25, 0.0, 0.2)
        elif name == "cheburashka":
            held, pulled, offset = z < 0.08, z > 0.95, (0.3, 0.0, 0.12)
        else:
            held, pulled, offset = z < 0.04, z > 0.85, (0.22, -0.05, 0.12)
        indices = np.concatenate([np.flatnonzero(held), np.flatnonzero(pulled)])
        targets = points[indices] + np.outer(pulled[indices], size * np.array(offset))
        found.append((name, shape, indices, targets))
    return found
