"""Deformation against SciPy and libigl."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import spectral_tv

from .arap import Arap
from .direct import Cholmod, Direct, SuperLU
from .meshes import Shape
from .page import Page
from .reweighted import reweighted
from .timing import RUNS, interleaved

LOW, HIGH = 0.05, 0.07
TOLERANCE = 1e-3
FRAMES = 30


class Pull:
    """A mesh that is pinned at one end of its longest axis and moved at the other."""

    def __init__(self, name: str, vertices: np.ndarray, triangles: np.ndarray) -> None:
        """Pin the lowest 5 % of the vertices, and move the highest 7 % by a fifth of the length."""
        self.name, self.vertices, self.triangles = name, vertices, triangles
        axis = np.ptp(vertices, axis=0).argmax()
        along = vertices[:, axis]
        low, high = np.quantile(along, [LOW, 1 - HIGH])
        self.indices = np.flatnonzero((along < low) | (along > high))
        self.moves = (along[self.indices] > high)[:, None]
        self.shift = np.roll([0.8, 0.5, 0.33], axis) * 0.2 * np.ptp(along)
        self.targets = self.at(1.0)

    def at(self, part: float, towards: float = 0.0) -> np.ndarray:
        """The targets for a part of the movement, bent aside."""
        shift = part * self.shift + towards * np.roll(self.shift, 1)
        return self.vertices[self.indices] + self.moves * shift

    def deform(self, **arguments: object) -> spectral_tv.Deformation:
        """Deform from scratch."""
        mesh = spectral_tv.Mesh(self.vertices, self.triangles)
        return spectral_tv.deform(mesh, self.indices, self.targets, **arguments)


def report(page: Page, shapes: list[tuple[str, Shape]]) -> None:
    """Print the tables."""
    pulls = [Pull(name, *shape) for name, shape in shapes]
    for name, measure, text, columns in TABLES:
        with page.table(name, text, f"mesh | vertices | {columns}") as row:
            for pull in pulls:
                row(pull.name, len(pull.vertices), *measure(pull))


def solving(pull: Pull) -> list[str]:
    """Measure full solutions of one mesh."""
    least = pull.deform(tolerance=1e-5).total_variation
    found = {}

    def ours() -> None:
        found["ours"] = pull.deform(tolerance=TOLERANCE)

    def theirs(name: str, solver: Callable[[], Direct]) -> Callable[[], None]:
        def run() -> None:
            found[name] = reweighted(
                pull.vertices,
                pull.triangles,
                pull.indices,
                pull.targets,
                least * (1 + TOLERANCE),
                solver(),
            )

        return run

    scipy, cholesky, seconds = interleaved(
        theirs("SciPy", SuperLU), theirs("CHOLMOD", Cholmod), ours
    )
    _, variation, systems = found["SciPy"]
    reached = "" if variation <= least * (1 + TOLERANCE) else f", {variation / least - 1:.1e} above"
    return [
        f"{scipy:.2f} s", f"{systems}{reached}", f"{cholesky:.2f} s", f"{seconds:.2f} s",
        str(found["ours"].iterations), f"{scipy / seconds:.1f}, {cholesky / seconds:.1f}",
    ]  # fmt: skip


def dragging(pull: Pull) -> list[str]:
    """Measure updates of one mesh while its handle is moved by 2 % of its way a frame."""
    mesh = spectral_tv.Mesh(pull.vertices, pull.triangles)
    deformer = spectral_tv.Deformer(mesh, pull.indices)
    deformer.solve(pull.targets)
    frames = [pull.at(1 + 0.01 * k, 0.02 * k) for k in range(1, FRAMES + 1)]
    remaining = iter(frames)
    dragged = []

    def ours() -> None:
        dragged.append(deformer.drag(next(remaining)))

    def theirs() -> None:
        enough = np.inf  # a single system
        reweighted(pull.vertices, pull.triangles, pull.indices, pull.targets, enough, Cholmod())

    cholesky, seconds = interleaved(theirs, ours, runs=FRAMES)
    checked = range(FRAMES // 3 - 1, FRAMES, FRAMES // 3)
    excess = max(
        dragged[k].total_variation
        / spectral_tv.deform(mesh, pull.indices, frames[k], tolerance=1e-5).total_variation
        - 1
        for k in checked
    )
    return [
        f"{1e3 * cholesky:.0f} ms", f"{1e3 * seconds:.0f} ms", f"{cholesky / seconds:.1f}",
        f"{1 / seconds:.0f}", f"{excess:.1e}",
    ]  # fmt: skip


def rigid(pull: Pull) -> list[str]:
    """Measure as-rigid-as-possible deformation of one mesh."""
    results = {}

    def ours() -> None:
        results["ours"] = pull.deform(algorithm="arap")

    ours()
    iterations = results["ours"].iterations

    def theirs() -> None:
        arap = Arap(pull.vertices, pull.triangles, pull.indices)
        arap.prepare()
        arap.iterate(pull.targets, iterations)
        results["libigl"] = arap.shape

    library, seconds = interleaved(theirs, ours)
    difference = np.abs(results["libigl"] - results["ours"].vertices).max()
    relative = difference / np.linalg.norm(pull.shift)
    return [
        str(iterations), f"{library:.2f} s", f"{seconds:.2f} s", f"{library / seconds:.1f}",
        f"{relative:.0e}",
    ]  # fmt: skip


TABLES: tuple[tuple[str, Callable[[Pull], list[str]], str, str], ...] = (
    (
        "deformation",
        solving,
        f"Deformation to a gap of {TOLERANCE:.1g}; SciPy reweights until its TV is as near to the "
        f"optimum, which it is told; medians of {RUNS} interleaved runs",
        "SciPy | its systems | SciPy, CHOLMOD | deform | iterations | ratios",
    ),
    (
        "dragging",
        dragging,
        f"Dragging, medians of {FRAMES} frames; CHOLMOD solves one reweighted system, all of its "
        "preparation included, which dragging has behind it",
        "CHOLMOD | drag | ratio | updates a second | worst excess of TV",
    ),
    (
        "rigid",
        rigid,
        f"As-rigid-as-possible (spokes and rims), the same number of iterations; medians of {RUNS} "
        "interleaved runs",
        "iterations | libigl | deform | ratio | difference",
    ),
)
