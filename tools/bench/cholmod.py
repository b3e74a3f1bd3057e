"""M1's semi-implicit steps in SciPy with CHOLMOD: what one would write without this library."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from sksparse.cholmod import analyze


def lagged_m1(vertices: np.ndarray, triangles: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Run the paper's step, one factorization each, the analysis done once.

    Parameters
    ----------
    vertices : (V, 3) array
    triangles : (F, 3) array of integers
    times : (N+1,) array, increasing from 0, length²

    Returns
    -------
    (N+1, V, 3) array
    """
    gradient, areas = gradient_and_areas(vertices, triangles)
    masses = np.bincount(triangles.ravel(), np.repeat(areas / 3, 3), len(vertices))
    masses[masses == 0] = masses.mean()
    epsilon = 1e-3 * np.sqrt(2)
    states = [vertices]
    factor = None
    for dt in np.diff(times):
        norms = np.linalg.norm((gradient @ states[-1]).reshape(-1, 9), axis=1)
        weights = areas / np.hypot(norms, epsilon)
        scaled = sp.diags_array(np.repeat(weights, 3)) @ gradient
        system = sp.csc_matrix(sp.diags_array(masses) + dt * (gradient.T @ scaled))
        factor = factor or analyze(system)
        factor.cholesky_inplace(system)
        states.append(factor(masses[:, None] * states[-1]))
    return np.array(states)


def gradient_and_areas(
    vertices: np.ndarray, triangles: np.ndarray
) -> tuple[sp.csr_array, np.ndarray]:
    """G (3F, V) and the face areas."""
    corners = vertices[triangles]
    opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    normals = np.cross(opposite[:, 0], opposite[:, 1])
    double = np.linalg.norm(normals, axis=1)
    hats = np.cross(normals[:, None], opposite) / (double**2)[:, None, None]
    faces = len(triangles)
    rows = np.broadcast_to(3 * np.arange(faces)[:, None, None] + np.arange(3), (faces, 3, 3))
    columns = np.broadcast_to(triangles[:, :, None], (faces, 3, 3))
    entries = (hats.ravel(), (rows.ravel(), columns.ravel()))
    return sp.csr_array(entries, shape=(3 * faces, len(vertices))), double / 2
