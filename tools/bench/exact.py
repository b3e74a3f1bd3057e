"""Exact steps of scalar TV flow against accelerated primal–dual iteration."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
import spectral_tv

from .meshes import sphere
from .operators import gradient_and_areas
from .page import Page
from .primal_dual import PrimalDual
from .timing import RUNS, interleaved

POLAR_ANGLE = 1.0
STEPS = 6
TOLERANCE = 1e-3


def report(page: Page, frequencies: tuple[int, ...]) -> None:
    """Print the table: the indicator of a cap, which decays in a straight line to extinction."""
    with page.table(
        "exact",
        f"Scalar TV flow of the indicator of a spherical cap, {STEPS} steps to extinction, each to "
        f"a gap of {TOLERANCE:.0e}; medians of {RUNS} interleaved runs",
        "vertices | primal–dual | its iterations | exact steps | ratio | difference",
    ) as row:
        for frequency in frequencies:
            row(*cells(frequency))


def cells(frequency: int) -> list[str]:
    """Measure one sphere; the difference is of the last states, relative to the initial jump."""
    vertices, triangles = sphere(frequency)
    mesh = spectral_tv.Mesh(vertices, triangles)
    cap = (np.arccos(np.clip(vertices[:, 2], -1, 1)) < POLAR_ANGLE).astype(float)
    # λ (1 + β) of the cap is its rate; it is extinct after 1 over that.
    share = (1 - np.cos(POLAR_ANGLE)) / 2
    rate = np.sin(POLAR_ANGLE) / (1 - np.cos(POLAR_ANGLE)) / (1 - share)
    times = np.linspace(0, 1 / rate, STEPS + 1)
    found = {}

    def theirs() -> None:
        gradient, areas = gradient_and_areas(vertices, triangles)
        masses = mesh.vertex_areas
        solver = PrimalDual(gradient, areas, sp.diags_array(masses).tocsr(), lambda x: x / masses)
        state, count = cap, 0
        for tau in np.diff(times):
            state, _, iterations = solver.step(state, tau, TOLERANCE)
            count += iterations
        found["theirs"], found["count"] = state, count

    def ours() -> None:
        flow = spectral_tv.flow(mesh, cap, times, exact=True, tolerance=TOLERANCE)
        found["ours"] = flow.states[-1]

    slow, seconds = interleaved(theirs, ours)
    difference = np.abs(found["theirs"] - found["ours"]).max()
    return [
        str(len(vertices)), f"{slow:.2f} s", str(found["count"]), f"{seconds:.3f} s",
        f"{slow / seconds:.0f}", f"{difference:.0e}",
    ]  # fmt: skip
