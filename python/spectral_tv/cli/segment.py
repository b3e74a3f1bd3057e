"""``segment``: files in, the same parts of all of them labelled alike."""

from collections.abc import Generator
from dataclasses import field
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import spectral_tv
from spectral_tv.cli.formats import FORMATS, with_colors, with_numbers
from spectral_tv.cli.reading import Read, read
from spectral_tv.cli.settings import SegmentSettings
from spectral_tv.cli.surface import Surface
from spectral_tv.cli.verb import FileVerb
from spectral_tv.cli.writing import Result
from spectral_tv.command_line.command import ERRORS
from spectral_tv.command_line.places import ensure_file
from spectral_tv.command_line.progress import progress
from spectral_tv.dataclass import dataclass
from spectral_tv.files.srgb import encoded
from spectral_tv.jobs.steps import Step, Steps, in_turn
from spectral_tv.notes import gathered, listed, note
from spectral_tv.segmentation.colors import color
from spectral_tv.segmentation.settings import DECOMPOSING, METHOD

Labels = NDArray[np.int64]
# What the numbers of parts are written as.
NAME = "segment"
STEPS = 255


@dataclass
class Shape:
    """One of the inputs: what it holds and its labels (N,), or why it takes no part; and what was
    noted of it."""

    surface: Surface | None = None
    labels: Labels | None = None
    error: Exception | None = None
    notes: list[str] = field(default_factory=list)


class Segment(FileVerb):
    """Finds the parts of all inputs together."""

    name = "segment"
    summary = "find the same parts in several meshes"
    description = """\
Find the parts of the meshes of all inputs together: the same part gets the same number in every
pose. The meshes need not have the same vertices. All meshes of a file are one surface. An input
that fails is left out, and the others go on.

Formats with numbers at the vertices have the number of the part there, as segment, from 1, the
largest part. All other formats that hold vertex colors have a color for each part."""
    examples = """\
  {program} segment pose1.ply pose2.ply pose3.ply -o labelled --format vtu --segments 8
  {program} segment cat.obj -o cat.glb"""

    options = SegmentSettings
    is_together = True
    result = "numbers or colors of its vertices"

    @classmethod
    def suffixes(cls) -> list[str]:
        """What it writes."""
        return [*with_numbers(), *(each for each in with_colors() if each not in with_numbers())]

    def treat(
        self, read: Read, source: Path, target: Path | None, done: dict[str, object]
    ) -> Result:
        """Take the labels of an input; all inputs are labelled with the first."""
        shape = self._labelled[source]
        for text in shape.notes:
            note(text)
        if shape.error is not None:
            raise shape.error
        if shape.surface is None or shape.labels is None:
            raise RuntimeError("it was not labelled")
        left_out = [str(each) for each, one in self._labelled.items() if one.error is not None]
        if left_out:
            note(f"labelled without {listed(left_out)}, which failed")
        done["together"] = [str(each) for each, one in self._labelled.items() if one.error is None]
        numbers = surface_labels(shape.surface, shape.labels)
        nowhere = int((numbers == 0).sum())
        if nowhere:
            note(f"{nowhere} vertices that are on no face are in no part: their number is 0")
        if target is None or FORMATS[target.suffix.lower()].has_numbers:
            if NAME in read.values:
                note(f"its own numbers {NAME} are replaced")
            return Result(numbers={NAME: numbers})
        return Result(colors=_colors(numbers, self.asked.segments))

    @cached_property
    def _labelled(self) -> dict[Path, Shape]:
        """All inputs, labelled together."""
        shapes = {source: self._read(source) for source in self.choices.inputs}
        good = {path: shape for path, shape in shapes.items() if shape.surface is not None}
        asked: SegmentSettings = self.asked
        starts = [
            partial(spectral_tv.start_decompose, shape.surface.mesh, METHOD, steps=asked.steps)
            for shape in good.values()
            if shape.surface is not None
        ]

        def steps() -> Generator[Step, Any, list[Labels]]:
            splits = yield from in_turn(starts, DECOMPOSING)
            return (yield spectral_tv.start_cosegment(splits, asked.segments, asked.seed), 1.0)

        if good:
            with progress(listed(map(str, good))) as show:
                found = Steps(steps()).result(show)
            for shape, labels in zip(good.values(), found, strict=True):
                shape.labels = labels
        return shapes

    def _read(self, source: Path) -> Shape:
        shape = Shape()
        with gathered() as shape.notes:
            try:
                ensure_file(source)
                shape.surface = Surface.of(read(source), self.asked)
            except ERRORS as error:
                shape.error = error
        return shape


def surface_labels(surface: Surface, labels: Labels) -> NDArray[np.int32]:
    """The numbers of the parts at the vertices of a file, (V,): from 1, and 0 of none."""
    return surface.to_vertices(labels + 1).astype(np.int32)


def _colors(numbers: NDArray[np.int32], count: int) -> NDArray[np.uint8]:
    """The colors of the parts at the vertices, (V, 4)."""
    palette = [(0.5, 0.5, 0.5), *(color(label) for label in range(count))]
    rows = np.rint(STEPS * encoded(np.array(palette))).astype(np.uint8)
    return np.column_stack([rows, np.full(len(rows), STEPS, np.uint8)])[numbers]
