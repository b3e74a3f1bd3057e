"""Deformation of least total variation in SciPy: what one would write without this library."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from .direct import Direct
from .operators import gradient_and_areas

SHRINKAGE = 0.6
SMALLEST = 1e-4
MOST_ITERATIONS = 150


def reweighted(
    vertices: np.ndarray,
    triangles: np.ndarray,
    indices: np.ndarray,
    targets: np.ndarray,
    enough: float,
    solver: Direct,
) -> tuple[np.ndarray, float, int]:
    """Repeat L(w) d = 0, w = 1/√(|∇d|² + ε²), ε shrinking, until TV(d) is `enough`.

    Parameters
    ----------
    vertices : (V, 3) array
    triangles : (F, 3) array of integers
    indices : (K,) array of integers
    targets : (K, 3) array
    enough : float
        The TV to reach, length².
    solver : Direct
        A new one.

    Returns
    -------
    (V, 3) array, the displacement; its TV; the number of systems solved
    """
    gradient, areas = gradient_and_areas(vertices, triangles)
    free = np.setdiff1d(np.arange(len(vertices)), indices)
    inner = gradient.tocsc()[:, free].tocsr()
    displacement = np.zeros_like(vertices)
    displacement[indices] = targets - vertices[indices]
    norms = np.ones(len(areas))
    epsilon = 0.0
    for iteration in range(MOST_ITERATIONS):
        weights = sp.diags_array(np.repeat(areas / np.hypot(norms, epsilon), 3))
        displacement[free] = 0
        system = sp.csc_matrix(inner.T @ (weights @ inner))
        known = inner.T @ (weights @ (gradient @ displacement))
        displacement[free] = solver.solve(system, -known)
        norms = np.linalg.norm((gradient @ displacement).reshape(-1, 9), axis=1)
        variation = float(areas @ norms)
        if iteration == 0:
            mean = variation / areas.sum()
        if variation <= enough:
            break
        epsilon = mean * max(SHRINKAGE ** (iteration + 1), SMALLEST)
    return displacement, variation, iteration + 1
