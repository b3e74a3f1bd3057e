"""How far the bands of a flow are from those of a refined one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def band_errors(
    areas: Array, times: Array, states: Array, fine_times: Array, fine_states: Array
) -> Array:
    """Relative error of five bands, (5,), with components spread evenly around their times.

    `areas` are those of the vertices; states are (N + 1, V, C) at times (N + 1,).
    """
    edges = np.append(0.0, np.geomspace(times[-1] / 1000, times[-1], 6)[1:])
    fine = spread_bands(fine_times, fine_states, edges)
    return relative_errors(areas, spread_bands(times, states, edges), fine)


def spread_bands(times: Array, states: Array, edges: Array) -> Array:
    """Bands (K, V, C) between edges (K + 1,), with components spread evenly around their times.

    Band sums of the same flow at other times differ by what falls to the wrong side of an edge;
    u − t u_t, interpolated linearly between the midpoints of the steps, does not.
    """
    dt = np.diff(times)[:, None, None]
    values = states[:-1] + times[:-1, None, None] * (states[:-1] - states[1:]) / dt
    nodes = np.append(0.0, (times[:-1] + times[1:]) / 2)
    values = np.concatenate([states[:1], values])
    k = np.clip(np.searchsorted(nodes, edges) - 1, 0, len(nodes) - 2)
    share = ((edges - nodes[k]) / (nodes[k + 1] - nodes[k]))[:, None, None]
    intercepts = (1 - share) * values[k] + share * values[k + 1]
    return intercepts[:-1] - intercepts[1:]


def relative_errors(areas: Array, bands: Array, fine: Array) -> Array:
    """L² errors of bands (K, V, C) over the surface, relative to the refined ones, (K,)."""
    weight = areas[None, :, None]
    error, norm = (np.sqrt((weight * x**2).sum(axis=(1, 2))) for x in (bands - fine, fine))
    return error / norm
