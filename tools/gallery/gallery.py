"""The folders of pictures, and the meshes of the gallery."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..demo.contact_sheet import Sheet
from . import figures
from .hard_surface import box
from .page import CELL, Shape, save
from .shapes import creature, from_folder, meteorite, monkey, terrain

# How the meshes that the paper shows, or that stand in for them, are seen best.
VIEWS = {
    "armadillo": {"azimuth": 25.0},
    "cheburashka": {"azimuth": 20.0},
    "igea": {"azimuth": 10.0, "elevation": 0.0},
    "lion_head": {"azimuth": 15.0, "elevation": 0.0},
    "michael0": {"azimuth": 15.0},
    "michael4": {"azimuth": 15.0},
    "michael13": {"azimuth": 15.0},
    "michael16": {"azimuth": 15.0},
    "spot": {"azimuth": 40.0},
    "stanford_bunny": {"azimuth": 15.0},
}
GENERATED: dict[str, Callable[[], Shape]] = {
    "dragon": creature,
    "man": figures.man,
    "dressed": figures.dressed,
    "bust": figures.bust,
    "suzanne": monkey,
    "stone": meteorite,
    "box": box,
    "terrain": terrain,
}
THEIRS = (
    "armadillo",
    "michael0",
    "michael13",
    "cheburashka",
    "spot",
    "igea",
    "lion_head",
    "stanford_bunny",
)


@dataclass(frozen=True)
class Gallery:
    """The folder of pictures, and that of meshes, if there is one."""

    output: Path
    meshes: Path | None

    def mesh(self, name: str) -> Shape | None:
        """A mesh of the folder; None where it is not there."""
        return from_folder(self.meshes, name, **VIEWS.get(name, {}))

    def subjects(self, *names: str) -> Iterator[tuple[str, Shape]]:
        """The generated creature, and those of the named meshes that there are."""
        yield "creature", creature()
        for name in names:
            shape = self.mesh(name)
            if shape is not None:
                yield name, shape

    def save(self, name: str, sheets: Sequence[Sheet], subject: str = "", cell: int = CELL) -> None:
        """Write a picture: of a mesh of the folder apart from the others."""
        is_own = subject in ("", "creature")
        file = f"{name}.png" if is_own else f"meshes/{name}_{subject}.png"
        save(self.output / file, sheets, cell)

    def models(self) -> Iterator[tuple[str, Shape, bool]]:
        """Shapes of the kinds that artists have, each with its name and whether it is generated:
        figures, a bust, scans, a machine, a landscape; then those of the folder.
        """
        for name, make in GENERATED.items():
            yield name, make(), True
        for name in THEIRS:
            shape = self.mesh(name)
            if shape is not None:
                yield name, shape, False
