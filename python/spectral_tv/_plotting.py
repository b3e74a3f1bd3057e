"""Pictures of spectra."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spectral_tv._native import Decomposition, Flow, MeshError
from spectral_tv._optional import needed

# How many bands are shown if no edges are given.
BANDS = 5
# Times whose last step is so many times the first are drawn by their logarithm.
GRADED = 2.0


def plot_spectrum(split: Decomposition | Flow, edges: ArrayLike | None, axes: Any) -> Any:
    """Draw S(t) over its bands into axes of Matplotlib, by default the current ones."""
    pyplot = needed("matplotlib.pyplot", "plot()", "plot")
    times, spectrum = split.times, split.spectrum
    found = edges_of(split, edges)
    axes = pyplot.gca() if axes is None else axes
    steps = np.diff(times)
    if steps[-1] > GRADED * steps[0]:
        axes.set_xscale("log")
    first, last = times[1] ** 2 / times[2], times[-1]
    cut = np.clip(found, first, last)
    colors = pyplot.colormaps["viridis"](np.linspace(0.15, 0.95, len(cut) - 1))
    for number, (color, start, end) in enumerate(zip(colors, cut, cut[1:], strict=False), start=1):
        axes.axvspan(start, end, color=color, alpha=0.35, linewidth=0, label=f"band {number}")
    axes.plot(times[1:-1], spectrum, color="black", marker=".", linewidth=1)
    axes.set_xlim(first, last)
    axes.set_ylim(bottom=0)
    axes.set_xlabel("t (length²)")
    axes.set_ylabel("S(t)")
    axes.legend(fontsize="small")
    return axes


def edges_of(split: Decomposition | Flow, edges: ArrayLike | None) -> Any:
    """The edges that were given, checked, or those of five bands or of as many as there can be."""
    count = len(split.times) - 2
    if count < 1:
        raise MeshError("there are no components, as the flow has one step alone")
    if edges is None:
        return split.band_edges(min(BANDS, count))
    found = np.asarray(edges, dtype=float)
    if found.ndim != 1 or len(found) < 2 or not (np.diff(found) > 0).all():
        raise MeshError("edges must be two or more increasing times")
    return found
