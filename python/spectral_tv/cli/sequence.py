"""Folders of numbered files: frames that are filtered by scales that are fixed once."""

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import spectral_tv
from spectral_tv.bands.fixed_scales import FixedScales
from spectral_tv.bands.settings import Settings
from spectral_tv.cli.formats import readable
from spectral_tv.cli.reading import read
from spectral_tv.cli.surface import Surface
from spectral_tv.cli.verb import FileVerb
from spectral_tv.command_line.frames import (
    ALL,
    METAVAR,
    add_scales,
    all_or_frames,
    complaint_of_scales,
)
from spectral_tv.command_line.places import is_folder, target_of
from spectral_tv.command_line.progress import say
from spectral_tv.command_line.report import Entry
from spectral_tv.files.numbered import Numbered, numbered
from spectral_tv.files.whole import ensure_writable
from spectral_tv.notes import gathered, note
from spectral_tv.refusal import Refusal


class SequenceVerb(FileVerb):
    """One with the arguments --frames and --scales; its ``options`` are `Settings`."""

    @staticmethod
    def add_frames(parser: argparse.ArgumentParser) -> None:
        """Declare that folders are sequences."""
        parser.add_argument(
            "--frames",
            metavar=METAVAR,
            type=all_or_frames,
            help="take a folder of numbered files as the frames of something that moves: these of "
            "them, or all. There is a file for each",
        )
        add_scales(parser)

    def complaint_of_frames(self) -> str | None:
        """What is wrong with inputs that should be sequences; None if nothing is."""
        choices, output = self.choices, self.choices.output
        if choices.frames is None:
            return complaint_of_scales(choices)
        for source in choices.inputs:
            if not is_folder(source):
                return f"--frames takes a folder of numbered files, and {source} is none"
            among = output if is_folder(output) else output.parent
            if among.resolve() == source.resolve():
                return f"the results would be among the frames in {source}; choose another folder"
        if choices.skip_existing:
            return "--skip-existing is not for --frames, as each frame has a file of its own"
        return None

    def is_one(self, folder: Path) -> bool:
        """Whether a folder is a sequence, and not one input for each file in it."""
        return self.choices.frames is not None and Numbered.are_in(folder, readable())

    def targets(self, source: Path) -> list[Path]:
        """The file that is written for an input; of a sequence, without a number."""
        if not is_folder(source):
            return super().targets(source)
        try:
            with gathered():
                source = Numbered.of(source, readable()).unnumbered
        except Refusal:  # which is told when it is read
            return []
        return [target_of(self.choices, source)]

    @cached_property
    def splitting(self) -> "Splitting":
        """What decomposes each mesh."""
        return Splitting(self.asked)

    def treat_file(self, source: Path, entry: Entry) -> None:
        """Read, treat and write a file, or the frames of a folder."""
        if not is_folder(source):
            super().treat_file(source, entry)
            return
        frames = None if self.choices.frames == ALL else self.choices.frames
        files = Numbered.of(source, readable()).chosen(frames)
        (target,) = self.targets(source)
        ensure_writable(target.absolute())
        self.splitting.begin(self._median_area(files) if self.choices.scales == "all" else None)
        entry.done = {"verb": self.name, "settings": self.told()}
        told, written = Told(), []
        for number, path in files.items():
            place = numbered(target, number)
            with told.of(path):
                found = read(path)
                self.finish(found, self.treat(found, path, place, entry.done), place)
            ends = [min(files), max(files)]
            entry.read = (
                entry.read or {"format": path.suffix.lower(), "frames": ends} | found.counts
            )
            written.append(str(place))
            entry.output = written
            say(f"{source}: wrote {place}")
        told.note()

    def _median_area(self, files: dict[int, Path]) -> float:
        """The median of the areas of frames, length²."""
        areas = []
        for path in files.values():
            with Told().of(path):  # what is noted is so again, later
                areas.append(Surface.of(read(path), self.asked).mesh.area)
        return float(np.median(areas))


class Told:
    """Which file an error is about, and each note once, with the first file that it is of."""

    def __init__(self) -> None:
        """Know no notes so far."""
        self._names: dict[str, str] = {}

    @contextmanager
    def of(self, path: Path) -> Iterator[None]:
        """Take what is told of a file meanwhile."""
        try:
            with gathered() as notes:
                yield
        except (Refusal, spectral_tv.MeshError) as error:
            raise Refusal(f"{path.name}: {error}") from error
        for text in notes:
            self._names.setdefault(text, path.name)

    def note(self) -> None:
        """Note it."""
        for text, name in self._names.items():
            note(f"{name}: {text}")


class Splitting:
    """Decomposes meshes: each by its own size, or all by the same where they are frames."""

    def __init__(self, settings: Settings) -> None:
        """Know no frame so far."""
        self._settings = settings
        self._is_sequence = False
        self._area: float | None = None
        self._fixed: FixedScales | None = None

    def begin(self, area: float | None) -> None:
        """Have meshes be frames from now on, with sizes relative to an area, or to the first's."""
        self._is_sequence, self._area, self._fixed = True, area, None

    def split(
        self,
        mesh: spectral_tv.Mesh,
        base: NDArray[np.float64] | None,
        show: Callable[[float], None],
    ) -> spectral_tv.Decomposition:
        """Decompose a mesh; ``show`` takes the fraction done."""
        arguments: dict[str, Any] = self._settings.arguments(mesh, base, self._area)
        if not self._is_sequence:
            return spectral_tv.decompose(mesh, progress=show, **arguments)
        if self._fixed is None:
            keeps = bool(self._settings.limbs_kept)
            self._fixed = FixedScales(arguments, self._area, keeps_limbs=keeps)
        return self._fixed.decompose(mesh, base, show)[1]
