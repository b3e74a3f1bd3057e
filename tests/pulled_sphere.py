"""A sphere whose ends are held and pulled, for the tests of deformations and of poses."""

from __future__ import annotations

import numpy as np
import spectral_tv
from shapes import ends, icosphere

PULL = [0.5, 0.0, 0.2]

VERTICES, TRIANGLES = icosphere(2)
LOW, HIGH = ends(VERTICES)
INDICES = np.concatenate([LOW, HIGH])
TARGETS = VERTICES[INDICES] + (VERTICES[INDICES, 2:] > 0) * PULL
COUNT = len(INDICES)


def large() -> tuple[spectral_tv.Mesh, np.ndarray, np.ndarray]:
    """A mesh on which solving takes a while, with its constraints and their targets."""
    vertices, triangles = icosphere(5)
    indices = np.concatenate(ends(vertices))
    targets = vertices[indices] + (vertices[indices, 2:] > 0) * PULL
    return spectral_tv.Mesh(vertices, triangles), indices, targets


def changed(array, index, value):
    """A copy with another value."""
    array = array.copy()
    array[index] = value
    return array
