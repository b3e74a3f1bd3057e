"""Poses against libigl's as-rigid-as-possible deformation and Blender's Laplacian Deform."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np

from .. import strain
from .arap import AT_A_TIME, Arap
from .laplacian_deform import LaplacianDeform
from .meshes import Shape
from .page import Page
from .timing import RUNS, interleaved, rate
from .turn import DEGREES, HIGH, LOW, Turn

TOLERANCE = 1e-4  # the default
# What moves by less than this, relative to the diagonal, changes nothing that is seen.
VISIBLE = 1e-4
# Where a side is taken to be settled: our tolerance, and libigl's movement.
SETTLED, SETTLED_MOVEMENT = 1e-7, 1e-5
# Of Laplacian Deform, and of libigl in a frame.
ITERATIONS, FRAME_ITERATIONS = (1, 20), (1, 2)
FRAMES = 30


def report(page: Page, shapes: list[tuple[str, Shape]]) -> None:
    """Print the table of full solutions."""
    ends = f"One end ({LOW:.0%}) held, the other ({HIGH:.0%}) turned by {DEGREES}°"
    with page.table(
        "posing",
        f"{ends}; medians of {RUNS} interleaved runs. pose stops at a decrement of "
        f"{TOLERANCE:.0e}, libigl where {AT_A_TIME} iterations move nothing by {VISIBLE:.0e} of "
        "the diagonal; Laplacian Deform has the named number of iterations",
        "mesh | vertices | handle | side | preparation | solution | iterations | "
        f"from its end | {strain.COLUMNS}",
    ) as row:
        for turn in turns(shapes):
            for cells in solving(turn):
                row(turn.name, len(turn.vertices), turn.way, *cells)


def report_dragging(page: Page, shapes: list[tuple[str, Shape]]) -> None:
    """Print the table of updates."""
    names = [f"libigl, {count}" for count in FRAME_ITERATIONS]
    names += [f"Laplacian Deform, {count}" for count in ITERATIONS]
    with page.table(
        "pose_dragging",
        f"Updates a second while the end is turned to {DEGREES}° in {FRAMES} frames, from the "
        "median; in brackets the largest distance at release from where it settles, relative to "
        "the diagonal. libigl goes on from the last frame by the named number of iterations",
        f"mesh | vertices | handle | Poser.drag | {' | '.join(names)}",
    ) as row:
        for turn in turns(shapes):
            row(turn.name, len(turn.vertices), turn.way, *dragging(turn))


def turns(shapes: list[tuple[str, Shape]]) -> Iterator[Turn]:
    """Both tasks of each shape, one at a time in Blender's scene."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for name, shape in shapes:
        for is_free in (True, False):
            yield Turn(name, *shape, is_free=is_free)


def solving(turn: Turn) -> Iterator[list[str]]:
    """Measure full solutions of a task; a row for each side."""
    posed: dict[str, object] = {}
    arap = Arap(turn.vertices, turn.triangles, turn.indices)
    modifiers = [LaplacianDeform(turn, count) for count in ITERATIONS]

    def prepare() -> None:
        posed["poser"] = turn.poser()

    def solve() -> None:
        posed["pose"] = posed["poser"].solve(turn.targets(), tolerance=TOLERANCE)

    def told() -> np.ndarray:
        return posed["pose"].vertices[turn.indices]

    def settle() -> None:
        posed["iterations"] = arap.settle(told(), VISIBLE)

    works = [prepare, solve, arap.prepare, settle]
    for modifier in modifiers:
        works += [modifier.prepare, lambda modifier=modifier: modifier.step(told())]
    seconds = iter(interleaved(*works))

    pose, shape = posed["pose"], arap.shape
    end = posed["poser"].solve(turn.targets(), tolerance=SETTLED).vertices
    arap.settle(told(), SETTLED_MOVEMENT)
    ends = [f"{turn.distance(*pair):.1e}" for pair in ((pose.vertices, end), (shape, arap.shape))]
    sides = [
        ("pose", pose.iterations, ends[0], pose.vertices),
        ("libigl, ARAP", posed["iterations"], ends[1], shape),
        *(("Laplacian Deform", each.iterations, "", each.shape) for each in modifiers),
    ]
    for name, iterations, off, moved in sides:
        taken = [f"{next(seconds):.2f} s" for _ in range(2)]
        found = strain.measured(turn.vertices, turn.triangles, moved)
        yield [name, *taken, str(iterations), off, *found.cells()]
    for modifier in modifiers:
        modifier.remove()


def dragging(turn: Turn) -> list[str]:
    """Measure updates of a task while its handle is turned."""
    poser = turn.poser()
    araps = [Arap(turn.vertices, turn.triangles, turn.indices) for _ in FRAME_ITERATIONS]
    modifiers = [LaplacianDeform(turn, count) for count in ITERATIONS]
    for each in (*araps, *modifiers):
        each.prepare()
    frames = iter([turn.targets(k / FRAMES) for k in range(1, FRAMES + 1)])
    shapes = [turn.vertices]

    def drag() -> None:
        shapes.append(poser.drag(next(frames)).vertices)

    def told() -> np.ndarray:
        return shapes[-1][turn.indices]

    works = [drag]
    works += [
        lambda arap=arap, count=count: arap.iterate(told(), count)
        for arap, count in zip(araps, FRAME_ITERATIONS, strict=True)
    ]
    works += [lambda modifier=modifier: modifier.step(told()) for modifier in modifiers]
    rates = [rate(seconds) for seconds in interleaved(*works, runs=FRAMES)]
    for modifier in modifiers:
        modifier.remove()
    lags = [turn.distance(shapes[-1], poser.solve(turn.targets(), tolerance=SETTLED).vertices)]
    released = [arap.shape for arap in araps]
    araps[-1].settle(told(), SETTLED_MOVEMENT)  # once: it takes minutes
    lags += [turn.distance(shape, araps[-1].shape) for shape in released]
    cells = [f"{often} ({lag:.1%})" for often, lag in zip(rates, lags, strict=False)]
    return [*cells, *rates[len(lags) :]]
