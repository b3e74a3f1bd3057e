"""The time that bands of the same accuracy take, in as many steps as each side needs."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable, Iterator

import numpy as np
import spectral_tv

from tests.band_errors import band_edges, relative_errors, soft_bands

from .lagged import lagged_steps
from .meshes import Shape
from .page import Page
from .process import Bench, Work
from .steps import LAST
from .timing import RUNS, interleaved

# The finest time of the default ones, relative to the last.
FINEST = 1.5e-3
REFINED = 1000
# Four in an octave: the fewest that suffice are found up to a quarter too many.
COUNTS = tuple(quarter << octave for octave in range(9) for quarter in range(4, 8))
GOALS = (0.1, 0.05)
LARGE = 100_000

Flow = Callable[[np.ndarray], np.ndarray]
# A number of steps with its error and its times: the fewest that suffice, or the most tried.
Plan = tuple[int, float, np.ndarray]
# Where in COUNTS searches ended, by what was searched for.
Places = dict[tuple[str, str, float], int]


def report(page: Page, shapes: Iterable[tuple[str, Shape]]) -> None:
    """Print the table."""
    with page.table(
        "accuracy",
        f"Up to a mean error of five bands against {REFINED} steps; medians of {RUNS} "
        f"interleaved runs, one run from {LARGE} vertices",
        "mesh | vertices | method | error | steps by Pardiso | its error | Pardiso | steps "
        "| error | here | ratio | of the steps",
    ) as row:
        found: Places = {}
        for name, shape in shapes:
            for method in LAST:
                for cells in compared(shape, method, found):
                    row(name, len(shape[0]), method.upper(), *cells)


def compared(shape: Shape, method: str, known: Places) -> Iterator[list[str]]:
    """The cells of a method for each goal; searches begin where those of other shapes ended."""
    vertices, triangles = shape
    mesh = spectral_tv.Mesh(vertices, triangles)
    last = LAST[method] * mesh.area

    def graded(count: int) -> np.ndarray:
        return spectral_tv.graded_times(FINEST * last, last, count)

    refined = graded(REFINED)
    fine = spectral_tv.decompose(mesh, method, times=refined).flow.states

    edges = band_edges(last)

    def bands(times: np.ndarray, states: np.ndarray) -> np.ndarray:
        return soft_bands(times, states.reshape(*states.shape[:2], -1), edges)

    fine_bands, begun = bands(refined, fine), fine[0].copy()
    del fine

    def ours(times: np.ndarray) -> np.ndarray:
        fresh = spectral_tv.Mesh(vertices, triangles)
        return spectral_tv.decompose(fresh, method, times=times).flow.states

    def theirs(times: np.ndarray) -> np.ndarray:
        # M3's own base differs a little, which is no error of its steps.
        return lagged_steps(vertices, triangles, times, method, "pardiso", begun)

    def error(states: np.ndarray, times: np.ndarray) -> float:
        found = bands(times, states)
        return float(relative_errors(mesh.vertex_areas, found, fine_bands).mean())

    def logarithmic(count: int) -> np.ndarray:
        return np.append(0, np.geomspace(last / 1000, last, count))

    def fewest(
        side: str, flow: Flow, *ways: Callable[[int], np.ndarray]
    ) -> Callable[[float], Plan]:
        @functools.cache
        def plan(count: int) -> Plan:
            tried = [(error(flow(times), times), times) for times in (way(count) for way in ways)]
            return count, *min(tried, key=lambda each: each[0])

        def found(goal: float) -> Plan:
            key = side, method, goal
            place = first_place(lambda place: plan(COUNTS[place])[1] <= goal, known.get(key))
            known[key] = min(place, len(COUNTS) - 1)
            return plan(COUNTS[known[key]])

        return found

    # Lagged steps on the times that suit them better.
    mine, them = fewest("here", ours, graded), fewest("there", theirs, graded, logarithmic)
    for goal in GOALS:
        ourselves, others = mine(goal), them(goal)
        runs = 1 if len(vertices) >= LARGE else RUNS
        works = (
            alone(shape, others[2], Work("pardiso", method)),
            alone(shape, ourselves[2], Work("spectral_tv", method, "extrapolated")),
        )
        slow, fast = interleaved(*works, runs=runs)
        # Where the most steps that were tried do not suffice, what follows from them is the least.
        least = "> " if others[1] > goal else ""
        ratios = [f"{least}{slow / fast:.0f}", f"{least}{others[0] / ourselves[0]:.1f}"]
        if ourselves[1] > goal:
            ratios = ["–", "–"]
        yield [
            f"{goal:.0%}", f"{least}{others[0]}", f"{others[1]:.1%}", f"{least}{slow:.2f} s",
            str(ourselves[0]), f"{ourselves[1]:.1%}", f"{fast:.3f} s", *ratios,
        ]  # fmt: skip


def first_place(is_enough: Callable[[int], bool], near: int | None) -> int:
    """The first place in COUNTS that is enough, as are all after it; beyond the last if none is."""
    below, above, stride = -1, len(COUNTS), 1
    place = (below + above) // 2 if near is None else near
    while above - below > 1:
        if is_enough(place):
            above = place
        else:
            below = place
        # Growing strides from `near`, until it lies between two places.
        if near is None or (below >= 0 and above < len(COUNTS)):
            place = (below + above) // 2
        else:
            place = max(place - stride, 0) if above == place else min(place + stride, above - 1)
            stride *= 2
    return above


def alone(shape: Shape, times: np.ndarray, work: Work) -> Callable[[], float]:
    """A flow in a process of its own: threads of Pardiso still wait actively when it has ended."""
    bench = Bench(shape, times)
    return lambda: bench.run(work).seconds
