"""Parts that are turned, followed in three ways, and how far the surface is strained."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import spectral_tv

from ..strain import measured, strains
from .figures import man
from .gallery import Gallery
from .limb_turns import PARTS, LimbTurn
from .page import Shape
from .shapes import creature
from .tables import write_row

CELL = 230
# The strain that is red.
MOST = 1.4
CLAY, RED = np.array([0.42, 0.38, 0.33]), np.array([0.7, 0.02, 0.01])
# Of the turn.
FURTHER = (2, 3)
# A pose with a larger decrement has not settled, by what Blender tells, and is marked.
UNSETTLED, MARK = 1e-3, "\\*"


def make(gallery: Gallery) -> None:
    """Pictures in clay, colored by strain; rows of the tables."""
    own = [_sheet(LimbTurn(name, shape, PARTS[name])) for name, shape in _generated()]
    gallery.save("poses", own, cell=CELL)
    for name, shape in _theirs(gallery):
        gallery.save("poses", [_sheet(LimbTurn(name, shape, PARTS[name]))], name, cell=CELL)
    for name, shape in (*_generated(), *_theirs(gallery)):
        for is_turned in (False, True):
            _tell(
                gallery.output / "poses.md", LimbTurn(name, shape, PARTS[name], is_turned=is_turned)
            )


def _generated() -> Iterator[tuple[str, Shape]]:
    yield "man", man()
    yield "dragon", creature()


def _theirs(gallery: Gallery) -> Iterator[tuple[str, Shape]]:
    for name in PARTS:
        shape = gallery.mesh(name)
        if shape is not None:
            yield name, shape


def _ways(turn: LimbTurn) -> list[tuple[str, np.ndarray]]:
    return [
        ("TV of displacements", turn.deformed("convex")),
        ("As rigid as possible", turn.deformed("arap")),
        ("Pose", turn.posed().vertices),
    ]


def _sheet(turn: LimbTurn) -> tuple[str, list]:
    ways, rest = _ways(turn), turn.shape.vertices
    shots = [(rest, _colors(turn, rest)), *((moved, _colors(turn, moved)) for _, moved in ways)]
    pictures = turn.shape.photograph(shots, cell=CELL)
    labels = ["Before", *(label for label, _ in ways)]
    name = turn.name.rstrip("0").capitalize()
    title = f"{name}: the {turn.part.title} by {turn.part.degrees}°"
    return title, [list(zip(labels, pictures, strict=True))]


def _colors(turn: LimbTurn, moved: np.ndarray) -> np.ndarray:
    """The strain as linear colors (V, 3)."""
    shape = turn.shape
    found = strains(shape.vertices, shape.triangles, moved)
    sums, counts = np.zeros((2, len(moved)))
    for corner in shape.triangles.T:
        np.add.at(sums, corner, np.minimum(found, MOST))
        np.add.at(counts, corner, 1)
    share = ((sums / np.maximum(counts, 1) - 1) / (MOST - 1)).clip(0, 1)[:, None]
    return (1 - share) * CLAY + share * RED


def _tell(page: Path, turn: LimbTurn) -> None:
    """Write the rows of both tables."""
    way = "turned" if turn.is_turned else "by position"
    name = f"| {turn.name}, {turn.part.title} {turn.part.degrees}°, {way}"
    others = [_measured(turn, turn.deformed(algorithm)) for algorithm in ("convex", "arap")]
    poses = [_told(turn, turn.posed(share)) for share in (1, *FURTHER)]
    write_row(page, "poses", f"{name} | {' | '.join([*others, poses[0]])} |")
    write_row(page, "further", f"{name} | {' | '.join(poses)} |")


def _told(turn: LimbTurn, pose: spectral_tv.Pose) -> str:
    """The measures of a pose, and whether it has settled."""
    return _measured(turn, pose.vertices) + (MARK if pose.decrement > UNSETTLED else "")


def _measured(turn: LimbTurn, moved: np.ndarray) -> str:
    found = measured(turn.shape.vertices, turn.shape.triangles, moved)
    return " / ".join(found.cells())
