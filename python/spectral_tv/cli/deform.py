"""``deform``: files in, shapes out of which parts were moved."""

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from spectral_tv.cli.formats import FORMATS, Holds
from spectral_tv.cli.grips import Grips
from spectral_tv.cli.reading import Read
from spectral_tv.cli.settings import DeformSettings
from spectral_tv.cli.surface import Surface
from spectral_tv.cli.verb import FileVerb
from spectral_tv.cli.writing import Result
from spectral_tv.command_line.progress import progress, say
from spectral_tv.deformation.parts import add_parts, complaint_of_parts, imply_algorithm
from spectral_tv.deformation.solvers import solver_of

# What the displacement is called where it is written beside the shape.
NAME = "deformation"


class Deform(FileVerb):
    """Moves parts of surfaces, and has the others follow."""

    name = "deform"
    summary = "move parts of meshes and have the others follow in rigid pieces"
    description = """\
Move parts of the meshes of files, hold others, and have the rest follow in rigid pieces. They turn,
with joints at narrow places; with --algorithm convex they shift only. An option that is for one
algorithm alone asks for it.

WHERE is numbers from 0 to 1 at the vertices of the file, by their name, or a region of the bounding
box along an axis of the file such as 'z<10%' or 'x>90%'. All meshes of a file are one surface.

A .glb has the shape as it was, and the deformation as a morph target at 1. All other formats hold
the deformed shape; some have the deformation beside it, as numbers at the vertices."""
    examples = """\
  {program} deform cat.ply -o cat.obj --pin 'z<10%' --move 'z>90%:0,0,0.2'
  {program} deform *.vtu -o bent --move 'head:0.1,0,0' --pin feet --softness 10"""

    options = DeformSettings
    example = "obj"

    @classmethod
    def add_own(cls, parser: argparse.ArgumentParser) -> None:
        """Declare what moves."""
        add_parts(parser, "the file's unit, along its axes; repeatable")
        parser.set_defaults(algorithm=None)

    def own_complaint(self) -> str | None:
        """What is wrong with the parts."""
        reason = complaint_of_parts(self.choices)
        if reason is None and not self.choices.moves:
            return "say what moves: --move"
        imply_algorithm(self.choices)
        return reason

    def treat(
        self, read: Read, source: Path, target: Path | None, _done: dict[str, object]
    ) -> Result:
        """Deform a surface."""
        choices, asked = self.choices, self.asked
        surface = Surface.of(read, asked)
        grips = Grips.of(read, surface, choices.pins, choices.moves, is_free=not choices.unturned)
        solver = solver_of(grips.held, asked)
        with progress(str(source)) as show:
            solved = solver.start(grips.targets).result(show)
        say(f"{source}: {solver.message(solved)}")
        moved: NDArray[np.float64] = solved.result.vertices - surface.mesh.vertices
        shift = {NAME: surface.to_vertices(moved)}
        kind = Holds.NOT if target is None else FORMATS[target.suffix.lower()].bands
        called = "" if kind is Holds.NOT else f"the {NAME}"
        shape = read.vertices + shift[NAME]
        return Result(shift, [1.0], called, arrays={**shift, "deformed": shape})
