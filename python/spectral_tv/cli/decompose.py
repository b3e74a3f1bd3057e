"""``decompose``: files in, bands or filtered shapes out."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import spectral_tv
from spectral_tv.bands.clamping import start_clamping
from spectral_tv.bands.counts import Counts
from spectral_tv.bands.filtering import KEEPS_ALL
from spectral_tv.bands.gain_arguments import add_gains, band_values, complaint_of_gains
from spectral_tv.bands.guard import STRETCH, add_safe, advice_of
from spectral_tv.bands.limits import Limited
from spectral_tv.cli.formats import FORMATS, Holds, told
from spectral_tv.cli.reading import Read
from spectral_tv.cli.sequence import SequenceVerb
from spectral_tv.cli.settings import FileLimit, FileSettings
from spectral_tv.cli.surface import Surface
from spectral_tv.cli.writing import Result
from spectral_tv.command_line.progress import progress
from spectral_tv.notes import note
from spectral_tv.options.arguments import add_arguments as add_options
from spectral_tv.options.arguments import read

Numbers = NDArray[np.float64]
SAFE = "safe"


class Decompose(SequenceVerb):
    """Splits files into bands, and filters them."""

    name = "decompose"
    summary = "split meshes into bands of detail"
    description = """\
Split the meshes of files into bands of detail, filter them, and write them.

All meshes of a file are one surface. A .glb has the bands as morph targets, set to the gains. All
other formats hold the filtered shape; some have the bands beside it, as numbers at the vertices."""
    examples = """\
  {program} decompose scan.obj -o smooth.obj --gain 1=0 --gain 2=0.5
  {program} decompose dragon.ply -o dragon.glb --bands 5
  {program} decompose *.stl -o results --format vtu --curve 0:0,0.5:1,1:2"""

    options = FileSettings

    @classmethod
    def formats(cls) -> str:
        """Lines that tell what it reads and writes."""
        return told()

    def estimate(self, vertices: int) -> spectral_tv.Estimate:
        """What it takes with a mesh of so many vertices."""
        return spectral_tv.estimate(vertices, self.asked.by.package, steps=self.asked.steps)

    @classmethod
    def add_own(cls, parser: argparse.ArgumentParser) -> None:
        """Declare how bands are filtered."""
        add_gains(parser)
        cls.add_frames(parser)
        add_safe(
            parser, "where bands are written, the result is one more, and the others are at gain 1"
        )
        add_options(parser, FileLimit)
        parser.add_argument(
            "--apply",
            action="store_true",
            help="write the result as the shape alone: files then have no bands",
        )

    def own_complaint(self) -> str | None:
        """What is wrong with the sizes, the bands and the gains."""
        asked = self.asked
        if 0 < asked.largest <= asked.finest:
            return "--largest has to be larger than --finest"
        reason = self.complaint_of_frames() or asked.complaint()
        return reason or complaint_of_gains(self.choices, asked.band_count)

    def treat(
        self, read: Read, source: Path, target: Path | None, _done: dict[str, object]
    ) -> Result:
        """Split a surface, and filter it."""
        asked: FileSettings = self.asked
        choices = self.choices
        values = band_values(choices, asked.band_count)
        holds = Holds.NOT if target is None else FORMATS[target.suffix.lower()].bands
        is_filtered = bool(choices.gains) or choices.curve is not None
        if not any(values) and (is_filtered or holds is Holds.NOT or choices.apply):
            note(KEEPS_ALL)
        mask = read.weights(asked.vertex_group) if asked.vertex_group else None
        surface = Surface.of(read, asked)
        with progress(str(source)) as show:
            split = self.splitting.split(surface.mesh, surface.base(asked), show)
        edges = split.band_edges(asked.band_count) if asked.by.has_bands else [0.0, np.inf]
        cut: Any = (asked.limbs_kept,) if asked.limbs_kept else ()
        bands = np.stack([surface.to_vertices(each) for each in split.bands(edges, *cut)])
        if mask is not None:
            bands *= mask[:, np.newaxis]
        named = {f"band_{number}": band for number, band in enumerate(bands, 1)}
        named, values = self._looked_at(named, values, surface, str(source))
        return self._result(read, self._held(named, values), values, np.asarray(edges))

    def _looked_at(
        self, bands: dict[str, Numbers], values: list[float], surface: Surface, label: str
    ) -> tuple[dict[str, Numbers], list[float]]:
        """Count what bands fold at their values, and clamp them if that is asked for."""
        counts = _counts(surface, _moves(bands, values))
        is_added = any(value > 0 for value in values)
        if not counts or not (self.choices.safe and is_added):
            if counts:
                note(f"at these gains {counts.told()}{advice_of(is_added)}")
            return bands, values
        taken = _moves(bands, np.minimum(values, 0))
        added = _moves(bands, np.maximum(values, 0))
        mesh = surface.mesh
        less, more = surface.merge(taken), surface.merge(added)
        left = spectral_tv.Mesh(mesh.vertices + less, mesh.triangles)
        with progress(f"{label}, clamping") as show:
            clamped = start_clamping(left, less, more, STRETCH).result(show)
        safe = taken + surface.to_vertices(clamped.shares)[:, np.newaxis] * added
        after = _counts(surface, safe)
        done = clamped.told(counts, after, repr(SAFE), takes=bool(taken.any()))
        note(f"{done}; the bands are at gain 1, and {SAFE} is shown")
        return bands | {SAFE: safe}, [0.0] * len(bands) + [1.0]

    def _held(self, bands: dict[str, Numbers], values: Sequence[float]) -> dict[str, Numbers]:
        """The bands, held within the limit at their values."""
        limit = read(self.choices, FileLimit).limit
        if limit <= 0:
            return bands
        away = np.linalg.norm(_moves(bands, values), axis=1)
        is_far = away > limit
        shares = np.ones(len(away))
        shares[is_far] = limit / away[is_far]
        held = Limited(limit, int(is_far.sum()), len(away), float(away.max(initial=0.0)), ())
        note(held.told(lambda length: f"{length:.4g}"))
        return {name: shares[:, np.newaxis] * each for name, each in bands.items()}

    def _result(
        self, read: Read, bands: dict[str, Numbers], values: Sequence[float], edges: Numbers
    ) -> Result:
        filtered = read.vertices + _moves(bands, values)
        if self.choices.apply:
            return Result(bands, values, arrays={"filtered": filtered})
        arrays = {
            "bands": np.stack([each for name, each in bands.items() if name != SAFE]),
            "values": np.asarray(values),
            "edges": edges,
            "filtered": filtered,
        }
        if SAFE in bands:
            arrays[SAFE] = bands[SAFE]
        return Result(bands, values, "the bands", arrays=arrays)


def _moves(bands: dict[str, Numbers], values: Sequence[float] | Numbers) -> Numbers:
    """What bands do at their values, (V, 3)."""
    return np.tensordot(np.asarray(values, float), np.stack(list(bands.values())), 1)


def _counts(surface: Surface, moves: Numbers) -> Counts:
    """How many faces fold and stretch where the file's vertices (V, 3) are moved so."""
    found = spectral_tv.folds(surface.mesh, surface.merge(moves))
    return Counts(len(found.flipped), len(found.stretched))
