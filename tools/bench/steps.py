"""The same steps of M1, M2 and M3 in SciPy and here: seconds, memory, difference."""

from __future__ import annotations

import os

import numpy as np

from .blas import optimized, reference
from .lagged import WAYS
from .meshes import Shape
from .operators import hats_and_areas
from .page import Page
from .process import Bench, Outcome, Work
from .timing import RUNS, interleaved

STEPS = 30
# The last time, relative to the area; the first is a thousandth of it.
LAST = {"m1": 2e-2, "m2": 3e-2, "m3": 1e-3}
# Meshes of more vertices are run once.
LARGE = 500_000
TRIAL = 4
# Solvers, as the table calls them.
NAMES = {"cholesky": "Cholesky", "single": "Cholesky, single", "multigrid": "multigrid"}


def report(page: Page, shapes: list[tuple[str, Shape]], *, least: bool) -> None:
    """Print the tables; with `least`, SciPy is left out for large meshes."""
    beside = []
    with page.table(
        "steps",
        f"{STEPS} steps; medians of {RUNS} interleaved runs, one run from {LARGE} vertices",
        "mesh | vertices | method | SciPy, plain | with care | with Pardiso | the same steps "
        "| ratios | on one thread | ratios | default steps | ratios",
    ) as row:
        for name, shape in shapes:
            for method in LAST:
                title = (name, len(shape[0]), method.upper())
                seconds, others = cells(shape, method, least)
                row(*title, *seconds)
                beside.append((*title, *others))
    with page.table(
        "memory",
        "The same steps",
        "mesh | vertices | method | solver | difference | memory, SciPy | memory | ratio",
    ) as row:
        for line in beside:
            row(*line)


def cells(shape: Shape, method: str, least: bool) -> tuple[list[str], list[str]]:
    """Measure one method on one mesh: cells of both tables."""
    is_large = len(shape[0]) >= LARGE
    area = hats_and_areas(*shape)[1].sum()
    times = np.append(0, np.geomspace(LAST[method] / 1000, LAST[method], STEPS) * area)
    bench = Bench(shape, times)
    found: dict[str, list[Outcome]] = {}

    def contestant(key: str, work: Work, environment: dict[str, str] | None = None):
        def run() -> float:
            found.setdefault(key, []).append(bench.run(work, environment))
            return found[key][-1].seconds

        return run

    single = {"RAYON_NUM_THREADS": "1"}
    contestants = {
        "lagged": contestant("lagged", Work("spectral_tv", method)),
        "single": contestant("single", Work("spectral_tv", method), single),
        "default": contestant("default", Work("spectral_tv", method, "extrapolated")),
    }
    if not (is_large and least):
        blas = fastest_blas(shape, times, method)
        contestants["careful"] = contestant("careful", Work("careful", method), blas)
        contestants["plain"] = contestant("plain", Work("plain", method), reference())
        contestants["pardiso"] = contestant("pardiso", Work("pardiso", method))
    runs = 1 if is_large else RUNS
    seconds = dict(zip(contestants, interleaved(*contestants.values(), runs=runs), strict=True))
    theirs = [seconds[key] for key in WAYS if key in seconds]

    def ratios(key: str) -> str:
        return ", ".join(f"{slow / seconds[key]:.1f}" for slow in theirs) or "–"

    def shown(key: str) -> str:
        return f"{seconds[key]:.2f} s" if key in seconds else "–"

    ours = found["lagged"][0]
    difference = memory = ratio = "–"
    if "careful" in found:
        them = found["careful"][0]
        size = np.ptp(shape[0], axis=0).max()
        difference = f"{np.abs(ours.states - them.states).max() / size:.0e}"
        memory, ratio = f"{them.megabytes:.0f} MB", f"{them.megabytes / ours.megabytes:.1f}"
    seconds_cells = [
        *map(shown, WAYS), shown("lagged"), ratios("lagged"), shown("single"), ratios("single"),
        shown("default"), ratios("default"),
    ]  # fmt: skip
    solver = chosen(shape, times, method)
    return seconds_cells, [solver, difference, memory, f"{ours.megabytes:.0f} MB", ratio]


def fastest_blas(shape: Shape, times: np.ndarray, method: str) -> dict[str, str]:
    """OpenBLAS with one thread or all, whichever takes some steps sooner."""
    bench = Bench(shape, times[:TRIAL])
    trials = [optimized(threads) for threads in {1, os.cpu_count()}]
    seconds = [bench.run(Work("careful", method), trial).seconds for trial in trials]
    return trials[int(np.argmin(seconds))]


def chosen(shape: Shape, times: np.ndarray, method: str) -> str:
    """The solver that "auto" takes: the one whose states are the same to the last bit."""
    bench = Bench(shape, times[:TRIAL])
    auto, *known = (
        bench.run(Work("spectral_tv", method, solver=solver)).states for solver in ("auto", *NAMES)
    )
    both = zip(NAMES.values(), known, strict=True)
    return " or ".join(name for name, states in both if np.array_equal(auto, states))
