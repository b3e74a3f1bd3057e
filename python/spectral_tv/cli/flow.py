"""``flow``: files in, numbers at the vertices flowed."""

import argparse
from dataclasses import replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import spectral_tv
from spectral_tv.attributes.flows import BAND, arguments, ensure_finite, functions
from spectral_tv.bands.filtering import FILTERED, filter_values
from spectral_tv.bands.gain_arguments import add_gains, complaint_of_gains, filter_of
from spectral_tv.cli.formats import with_colors, with_numbers
from spectral_tv.cli.reading import Read
from spectral_tv.cli.settings import FlowSettings
from spectral_tv.cli.surface import Surface
from spectral_tv.cli.verb import FileVerb
from spectral_tv.cli.writing import Result
from spectral_tv.command_line.progress import progress
from spectral_tv.notes import listed, note
from spectral_tv.options.arguments import read as read_options
from spectral_tv.refusal import Refusal

Numbers = NDArray[np.float64]
COLOR = "color"
# Of colors in files, and how far they may be beyond black and white before something is lost.
STEPS, HALF_STEP = 255, 0.5 / 255


class Flow(FileVerb):
    """Flows numbers at vertices."""

    name = "flow"
    summary = "smooth or filter numbers or colors at the vertices of meshes"
    description = """\
Flow numbers at the vertices of files, or their vertex colors, by total variation or heat, and write
them smoothed, filtered, or as bands that add up to them.

The result is written beside what it is of, such as height_flow, height_filtered, height_band_1 and
height_rest. Colors that are smoothed or filtered take the place of the file's own where the format
holds vertex colors; they are flowed as the file has them, and alpha stays."""
    examples = """\
  {program} flow scan.vtu -o smooth.vtu --source curvature --size 5
  {program} flow scan.ply -o scan.vtu --source height --result bands --bands 4
  {program} flow colored.ply -o clean.ply --kind color --result filter --gain 1=0"""

    options = FlowSettings
    result = "numbers at its vertices"

    @classmethod
    def suffixes(cls) -> list[str]:
        """What it writes."""
        return [*with_numbers(), *(each for each in with_colors() if each not in with_numbers())]

    @classmethod
    def add_own(cls, parser: argparse.ArgumentParser) -> None:
        """Declare the filter."""
        add_gains(parser)

    @cached_property
    def asked(self) -> FlowSettings:
        """The options that were chosen, and the filter."""
        found: FlowSettings = read_options(self.choices, FlowSettings)
        return replace(found, **filter_of(self.choices, found.bands))

    def holding(self) -> list[str]:
        """The suffixes of what holds the result that was asked for."""
        is_color = self.asked.kind == "COLOR" and self.asked.result != "BANDS"
        return self.suffixes() if is_color else with_numbers()

    def own_complaint(self) -> str | None:
        """What is wrong with the sizes, the bands and the gains."""
        choices = self.choices
        if (choices.gains or choices.curve) and not FILTERED.holds(self.asked):
            return "--gain and --curve go with --result filter"
        reason = complaint_of_gains(choices, self.asked.bands)
        if reason is not None:
            return reason
        try:
            self.asked.check()
        except Refusal as error:
            return str(error)
        return None

    def treat(
        self, read: Read, source: Path, target: Path | None, done: dict[str, object]
    ) -> Result:
        """Flow what was chosen."""
        asked = self.asked
        name, values, alpha = _source(read, asked)
        done["source"] = name
        surface = Surface.of(read, asked)
        merged = surface.merge(values)
        found = arguments(name, merged, surface.mesh.area, asked)
        with progress(str(source)) as show:
            flow = spectral_tv.flow(surface.mesh, progress=show, **found)
        if found.get("elements") == "edges":
            note(f"{name!r} was flowed on edges")
        gains = filter_values(asked) if FILTERED.holds(asked) else []
        results = {
            label: surface.to_vertices(each)
            for label, each in functions(flow, asked, gains).items()
        }
        is_colored = target is not None and target.suffix.lower() in with_colors()
        if alpha is not None and is_colored and asked.result != "BANDS":
            (colors,) = results.values()
            return Result(colors=_as_colors(colors, alpha))
        return _written(read, name, results)


def _source(read: Read, asked: FlowSettings) -> tuple[str, Numbers, NDArray[np.uint8] | None]:
    """The name and the values (V, C) of what is flowed, and the alpha (V,) of colors."""
    if asked.kind == "COLOR":
        colors = read.colors
        if colors is None:
            has = f"; it has {listed(read.looks)}" if read.looks else ""
            raise Refusal(f"it has no vertex colors{has}")
        return COLOR, colors[:, :3] / STEPS, colors[:, 3]
    name = asked.source
    if not name:
        if len(read.values) != 1:
            there = ", ".join(read.values) or "none"
            raise Refusal(f"name the numbers at its vertices by --source; there are: {there}")
        (name,) = read.values
    values = read.numbers(name)
    values = values.reshape(len(values), -1)
    ensure_finite(name, values)
    return name, values, None


def _as_colors(colors: Numbers, alpha: NDArray[np.uint8]) -> NDArray[np.uint8]:
    beyond = np.abs(colors - colors.clip(0, 1)) > HALF_STEP
    cut = int(beyond.any(axis=1).sum())
    if cut:
        note(f"the colors of {cut} vertices were cut off at black and white")
    whole = np.rint(colors.clip(0, 1) * STEPS).astype(np.uint8)
    return np.column_stack([whole, alpha])


def _written(read: Read, name: str, results: dict[str, Numbers]) -> Result:
    """Results by the names that they are written as; notes those that are written over others."""
    numbers = {}
    for label, values in results.items():
        key = f"{name}_{label.lower().replace(' ', '_')}"
        numbers[key] = values[:, 0] if values.shape[1] == 1 else values
    taken = [key for key in numbers if key in read.values]
    if taken:
        note(f"its own numbers {listed(taken)} are replaced")
    if any(label.startswith(BAND) for label in results):
        stale = [
            key for key in read.values if key.startswith(f"{name}_band_") and key not in numbers
        ]
        if stale:
            note(f"of other bands, and kept: {listed(stale)}")
    return Result(numbers=numbers)
