"""Deformation of least total variation in SciPy: what one would write without this library."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu
from sksparse.cholmod import analyze

from .operators import gradient_and_areas

Solve = Callable[[np.ndarray], np.ndarray]
Factorize = Callable[[sp.csc_matrix], Solve]

SHRINKAGE = 0.6
SMALLEST = 1e-4
MOST_ITERATIONS = 150


def superlu() -> Factorize:
    """SciPy's own sparse solver, in its mode for symmetric matrices."""

    def factorize(system: sp.csc_matrix) -> Solve:
        options = {"SymmetricMode": True}
        return splu(
            system, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options
        ).solve

    return factorize


def cholmod() -> Factorize:
    """CHOLMOD, the analysis done once."""
    factors = []

    def factorize(system: sp.csc_matrix) -> Solve:
        if not factors:
            factors.append(analyze(system))
        factors[0].cholesky_inplace(system)
        return factors[0]

    return factorize


def reweighted(
    vertices: np.ndarray,
    triangles: np.ndarray,
    indices: np.ndarray,
    targets: np.ndarray,
    enough: float,
    factorize: Factorize,
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
    factorize : callable
        `superlu()` or `cholmod()`.

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
        displacement[free] = factorize(system)(-known)
        norms = np.linalg.norm((gradient @ displacement).reshape(-1, 9), axis=1)
        variation = float(areas @ norms)
        if iteration == 0:
            mean = variation / areas.sum()
        if variation <= enough:
            break
        epsilon = mean * max(SHRINKAGE ** (iteration + 1), SMALLEST)
    return displacement, variation, iteration + 1
