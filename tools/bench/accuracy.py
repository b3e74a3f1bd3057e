"""The time that M1's bands of the same accuracy take, in as many steps as each side needs."""

from __future__ import annotations

import numpy as np
import spectral_tv

from tests.band_errors import band_errors

from .cholmod import lagged_steps
from .meshes import Shape
from .page import Page
from .timing import RUNS, interleaved

LAST, FINEST = 2e-2, 3e-5
REFINED = 1000
COUNTS = (6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512, 768)
GOALS = (0.2, 0.1, 0.05, 0.02)


def report(page: Page, name: str, shape: Shape) -> None:
    """Print the table."""
    vertices, triangles = shape
    mesh = spectral_tv.Mesh(vertices, triangles)
    graded = {count: graded_times(mesh.area, count) for count in (*COUNTS, REFINED)}
    fine = spectral_tv.decompose(mesh, "m1", times=graded[REFINED]).flow.states

    def ours(times: np.ndarray) -> np.ndarray:
        fresh = spectral_tv.Mesh(vertices, triangles)
        return spectral_tv.decompose(fresh, "m1", times=times).flow.states

    def theirs(times: np.ndarray) -> np.ndarray:
        return lagged_steps(vertices, triangles, times, "m1", plain=False)

    def error(states: np.ndarray, times: np.ndarray) -> float:
        areas = mesh.vertex_areas
        return float(band_errors(areas, times, states, graded[REFINED], fine).mean())

    def best(times: dict[int, np.ndarray]) -> dict[int, float]:
        return {count: error(theirs(times[count]), times[count]) for count in times}

    our_errors = {count: error(ours(graded[count]), graded[count]) for count in COUNTS}
    # SciPy's steps on the times that suit them better.
    logarithmic = {count: log_times(mesh.area, count) for count in COUNTS}
    plans = [{count: graded[count] for count in COUNTS}, logarithmic]
    found = [best(plan) for plan in plans]
    better = {count: int(found[1][count] < found[0][count]) for count in COUNTS}
    their_errors = {count: found[better[count]][count] for count in COUNTS}
    least = min(their_errors.values())
    with page.table(
        "accuracy",
        f"M1 on {name}, {len(vertices)} vertices, up to a mean error of five bands against "
        f"{REFINED} steps, from which {COUNTS[-1]} of SciPy's are {least:.1%} off; medians of "
        f"{RUNS} interleaved runs",
        "error | SciPy's steps | its error | SciPy | steps | error | here | ratio | of the steps",
    ) as row:
        for goal in GOALS:
            mine, them = fewest(our_errors, goal), fewest(their_errors, goal)
            if mine is None or them is None:
                row(f"{goal:.0%}", *(f"> {COUNTS[-1]}" if n is None else n for n in (them, mine)))
                continue
            plan = plans[better[them]][them]
            slow, fast = interleaved(discarded(theirs, plan), discarded(ours, graded[mine]))
            row(
                f"{goal:.0%}", them, f"{their_errors[them]:.1%}", f"{slow:.2f} s", mine,
                f"{our_errors[mine]:.1%}", f"{fast:.3f} s", f"{slow / fast:.0f}",
                f"{them / mine:.1f}",
            )  # fmt: skip


def discarded(flow, times: np.ndarray):
    """A flow whose states are not kept."""

    def run() -> None:
        flow(times)

    return run


def fewest(errors: dict[int, float], goal: float) -> int | None:
    """The fewest steps of no more than this error."""
    return next((count for count, error in errors.items() if error <= goal), None)


def graded_times(area: float, steps: int) -> np.ndarray:
    """Times spaced as the default ones are."""
    return spectral_tv.graded_times(FINEST * area, LAST * area, steps)


def log_times(area: float, steps: int) -> np.ndarray:
    """Times spaced evenly in their logarithm over three decades."""
    return np.append(0, np.geomspace(LAST / 1000, LAST, steps) * area)
