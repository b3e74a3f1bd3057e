"""Edge-keeping detail (M3) against filtering by Laplace–Beltrami eigenpairs."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
import spectral_tv
from scipy.optimize import nnls
from scipy.sparse.linalg import eigsh

from .meshes import Shape
from .operators import gradient_and_areas
from .page import Page
from .timing import RUNS, timed

COUNTS = (100, 200, 300)
PAPER = 2000


def report(page: Page, name: str, shape: Shape, *, everything: bool) -> None:
    """Print the table; with `everything`, the paper's number of pairs is measured too."""
    with page.table(
        "eigenpairs",
        "Low-pass by Laplace–Beltrami eigenpairs (ARPACK, shift and invert) once, and M3 with its "
        f"base, the median of {RUNS} runs before it and {RUNS} after; {name}, "
        f"{len(shape[0])} vertices",
        "pairs | how | seconds | M3 | ratio",
    ) as row:
        detail(shape)  # everything is loaded then
        runs = details(shape)

        def line(count: int, how: str, seconds: float) -> None:
            ours = float(np.median(runs[-2 * RUNS :]))
            row(count, how, f"{seconds:.1f} s", f"{ours:.2f} s", f"{seconds / ours:.0f}")

        def measured(count: int) -> float:
            seconds = timed(lambda: low_pass(shape, count))
            runs.extend(details(shape))
            line(count, "measured", seconds)
            return seconds

        seconds = [measured(count) for count in COUNTS]
        line(PAPER, f"in proportion to {COUNTS[-1]}", seconds[-1] * PAPER / COUNTS[-1])
        line(PAPER, "a k + b k² through the measured", extrapolated(COUNTS, seconds, PAPER))
        if everything and len(shape[0]) > PAPER:
            measured(PAPER)


def details(shape: Shape) -> list[float]:
    """Seconds that M3 takes."""
    return [timed(lambda: detail(shape)) for _ in range(RUNS)]


def extrapolated(counts: tuple[int, ...], seconds: list[float], count: int) -> float:
    """Seconds for `count` pairs by the least-squares a k + b k², a and b ≥ 0.

    Solves grow with k, keeping k vectors orthogonal with k².
    """
    k = np.array(counts, dtype=float)
    factors, _ = nnls(np.stack([k, k**2], axis=1), np.array(seconds))
    return float(factors @ [count, count**2])


def detail(shape: Shape) -> None:
    """Half of M3's detail, from the arrays on."""
    split = spectral_tv.decompose(spectral_tv.Mesh(*shape), "m3")
    split.filter(lambda _: 0.5)


def low_pass(shape: Shape, count: int) -> np.ndarray:
    """Low-pass a shape by its first eigenfunctions, (V, 3)."""
    vertices, triangles = shape
    gradient, areas = gradient_and_areas(vertices, triangles)
    laplacian = (gradient.T @ sp.diags_array(np.repeat(areas, 3)) @ gradient).tocsc()
    masses = np.bincount(triangles.ravel(), np.repeat(areas / 3, 3), len(vertices))
    _, modes = eigsh(laplacian, k=count, M=sp.diags_array(masses).tocsc(), sigma=-1e-6)
    return modes @ (modes.T @ (masses[:, None] * vertices))
