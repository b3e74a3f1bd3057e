"""How far the bands of a flow are from those of a refined one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

Array = NDArray[np.float64]


# Of an edge, in ln t.
WIDTH = 0.2


def band_errors(
    areas: Array, times: Array, states: Array, fine_times: Array, fine_states: Array
) -> Array:
    """Relative error of five bands, (5,).

    `areas` are those of the vertices; states are (N + 1, V, C) at times (N + 1,).
    """
    edges = band_edges(times[-1])
    fine = soft_bands(fine_times, fine_states, edges)
    return relative_errors(areas, soft_bands(times, states, edges), fine)


def band_edges(last: float) -> Array:
    """Edges (6,) of the five bands whose errors are told, even in ln t up to the last time."""
    return np.append(0.0, np.geomspace(last / 1000, last, 6)[1:])


def soft_bands(times: Array, states: Array, edges: Array) -> Array:
    """Bands (K, V[, C]) between edges (K + 1,), which are 0.2 wide in ln t."""
    left = np.stack([remainder(times, states, edge) for edge in edges])
    return left[:-1] - left[1:]


def remainder(times: Array, states: Array, edge: float = np.inf) -> Array:
    """u − t u_t at an edge, (V[, C]), by differences over its width between cubics."""
    if edge <= 0:
        return states[0]
    end = min(edge * np.exp(WIDTH / 2), times[-1])
    start = end * np.exp(-WIDTH)
    # Slopes at both ends of each cubic need a state more on either side.
    first = int(np.searchsorted(times, start, "right"))
    last = int(np.searchsorted(times, end, "left"))
    near = slice(max(first - 2, 0), max(last + 2, 3))
    times, states = times[near], states[near]
    slopes = np.gradient(states, times, axis=0, edge_order=2)
    if times[0] == 0:
        slopes[0] = (states[1] - states[0]) / times[1]
    u = CubicHermiteSpline(times, states, slopes)([start, end])
    return (end * u[0] - start * u[1]) / (end - start)


def relative_errors(areas: Array, bands: Array, fine: Array) -> Array:
    """L² errors of bands (K, V, C) over the surface, relative to the refined ones, (K,)."""
    weight = areas[None, :, None]
    error, norm = (np.sqrt((weight * x**2).sum(axis=(1, 2))) for x in (bands - fine, fine))
    return error / norm
