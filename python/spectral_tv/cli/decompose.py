"""``decompose``: files in, bands or filtered shapes out."""

import argparse
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import spectral_tv
from spectral_tv.bands.counts import Counts
from spectral_tv.bands.gain_arguments import add_gains, band_values, complaint_of_gains
from spectral_tv.bands.joining import joined
from spectral_tv.cli.formats import FORMATS, Holds, told
from spectral_tv.cli.reading import Read, read
from spectral_tv.cli.settings import FileSettings
from spectral_tv.cli.writing import Bands, write
from spectral_tv.command_line.command import Command
from spectral_tv.command_line.places import (
    add_places,
    add_report,
    complaint_of_clashes,
    complaint_of_places,
    ensure_file,
    is_folder,
    target_of,
)
from spectral_tv.command_line.progress import progress, say
from spectral_tv.command_line.report import Entry
from spectral_tv.files.whole import ensure_writable
from spectral_tv.notes import note
from spectral_tv.options.arguments import add_arguments as add_options
from spectral_tv.options.arguments import complaint
from spectral_tv.refusal import Refusal

Numbers = NDArray[np.float64]


class Decompose(Command):
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

    @staticmethod
    def formats() -> str:
        """Lines that tell what it reads and writes."""
        return told()

    @classmethod
    def add_arguments(cls, parser: argparse.ArgumentParser) -> None:
        """Declare what is split off, and how it is filtered."""
        add_places(parser, "a file with a mesh", "the file", "vtu", is_required=True)
        add_options(parser, FileSettings)
        add_gains(parser)
        add_report(parser)

    def complaint(self) -> str | None:
        """What is wrong with the arguments together; None if nothing is."""
        choices, asked = self.choices, self.asked
        reason = complaint_of_places(choices, [("-o", choices.output)])
        reason = reason or self._complaint_of_targets()
        if reason is None and 0 < asked.largest <= asked.finest:
            return "--largest has to be larger than --finest"
        reason = reason or complaint(choices, FileSettings, asked) or asked.complaint()
        return reason or complaint_of_gains(choices, asked.band_count)

    def _complaint_of_targets(self) -> str | None:
        targets = [target_of(self.choices, source) for source in self.choices.inputs]
        for target in targets:
            kind = FORMATS.get(target.suffix.lower())
            if kind is None or not kind.writes:
                hint = "; choose another with --format" if is_folder(self.choices.output) else ""
                return f"there is no way to write {target.suffix or 'files without suffix'}{hint}"
        return complaint_of_clashes(self.choices, targets)

    def treat_file(self, source: Path, entry: Entry) -> None:
        """Split, filter and write a file, and say so in ``entry``."""
        target = target_of(self.choices, source)
        ensure_file(source)
        ensure_writable(target.absolute())
        found = read(source)
        entry.read = {"format": source.suffix.lower(), **found.counts}
        bands = self._bands(found, str(source), FORMATS[target.suffix.lower()].bands)
        entry.done = {"verb": self.name, "settings": self.told()}
        write(found, bands, target)
        entry.output = str(target)
        say(f"{source}: wrote {target}")

    def _bands(self, found: Read, label: str, holds: Holds) -> Bands:
        """Split a surface; raises Refusal or spectral_tv.MeshError."""
        asked: FileSettings = self.asked
        values = band_values(self.choices, asked.band_count)
        if not any(values) and holds is Holds.NOT:
            note("the filter changes nothing: all gains are 1")
        mask = _mask(found, asked.vertex_group)
        mesh = joined(found.vertices, found.triangles, asked.weld, asked.leaves_out)
        arguments = asked.arguments(mesh, _flat(mesh) if asked.base == "FLAT" else None)
        with progress(label) as show:
            split = spectral_tv.decompose(mesh, progress=show, **arguments)
        edges = split.band_edges(asked.band_count) if asked.by.has_bands else [0.0, np.inf]
        cut: Any = (asked.limbs_kept,) if asked.limbs_kept else ()
        place = mesh.weld_map
        bands = split.bands(edges, *cut)[:, place]
        bands[:, place < 0] = 0
        bands *= mask[:, np.newaxis]
        made = Bands(bands, values, np.asarray(edges))
        if any(values):
            _note_folds(mesh, made.moves)
        return made


def _mask(found: Read, name: str) -> Numbers:
    """How much of the bands reaches every vertex, (V,)."""
    if not name:
        return np.ones(len(found.vertices))
    if name not in found.values:
        there = ", ".join(found.values) or "none"
        raise Refusal(f"there are no numbers {name!r} at its vertices; there are: {there}")
    return np.clip(found.values[name], 0, 1)


def _flat(mesh: spectral_tv.Mesh) -> Numbers:
    """A mesh pressed flat along the Z axis, (N, 3)."""
    vertices = mesh.vertices
    vertices[:, 2] = vertices[:, 2].min()
    return vertices


def _note_folds(mesh: spectral_tv.Mesh, moves: Numbers) -> None:
    """Note how many faces fold and stretch where vertices (V, 3) are moved so."""
    place = mesh.weld_map
    displacement = np.zeros((len(mesh.vertex_areas), 3))
    displacement[place[place >= 0]] = moves[place >= 0]
    found = spectral_tv.folds(mesh, displacement)
    counts = Counts(len(found.flipped), len(found.stretched))
    if counts:
        note(f"at these gains {counts.told()}")
