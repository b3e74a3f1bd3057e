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
    split_seconds = float(np.median([timed(lambda: detail(shape)) for _ in range(RUNS)]))
    with page.table(
        "eigenpairs",
        f"Low-pass by Laplace–Beltrami eigenpairs (ARPACK, shift and invert) once, and M3 with its "
        f"base, {split_seconds:.2f} s, the median of {RUNS} runs; {name}, {len(shape[0])} vertices",
        "pairs | how | seconds | ratio to M3",
    ) as row:

        def line(count: int, how: str, seconds: float) -> None:
            row(count, how, f"{seconds:.1f}", f"{seconds / split_seconds:.0f}")

        seconds = [timed(lambda count=count: low_pass(shape, count)) for count in COUNTS]
        for count, taken in zip(COUNTS, seconds, strict=True):
            line(count, "measured", taken)
        line(PAPER, f"in proportion to {COUNTS[-1]}", seconds[-1] * PAPER / COUNTS[-1])
        line(PAPER, "a k + b k² through the measured", extrapolated(COUNTS, seconds, PAPER))
        if everything and len(shape[0]) > PAPER:
            line(PAPER, "measured", timed(lambda: low_pass(shape, PAPER)))


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
