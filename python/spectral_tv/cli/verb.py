"""What the verbs about files do: read each, treat it, and write what came of it."""

import argparse
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import ClassVar

import spectral_tv
from spectral_tv.cli.formats import FORMATS, readable, writable
from spectral_tv.cli.reading import Read, read
from spectral_tv.cli.writing import Result, write
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
from spectral_tv.command_line.progress import say
from spectral_tv.command_line.report import Entry
from spectral_tv.files.whole import ensure_writable
from spectral_tv.notes import a
from spectral_tv.options.arguments import add_arguments as add_options
from spectral_tv.options.arguments import complaint

# What a process takes beside the work, and the readers of files for each byte; bytes.
PROCESS, READING = 200_000_000, 10


class FileVerb(Command):
    """One about meshes in files; its ``options`` have `ReadingSettings` among them."""

    # A suffix as an example of what is written, whether an output has to be named, and what
    # formats that are not written do not hold.
    example: ClassVar[str] = "vtu"
    is_required: ClassVar[bool] = True
    result: ClassVar[str] = "the result"

    @classmethod
    def suffixes(cls) -> list[str]:
        """What it writes."""
        return writable()

    @classmethod
    def formats(cls) -> str:
        """Lines that tell what it reads and writes."""
        return f"reads:  {' '.join(readable())}\nwrites: {' '.join(cls.suffixes())}"

    @classmethod
    def reads(cls) -> Collection[str]:
        """Of files in folders, those that end so are taken."""
        return readable()

    def targets(self, source: Path) -> list[Path]:
        """The file that is written for an input, if any."""
        return [] if self.choices.output is None else [target_of(self.choices, source)]

    def need(self, source: Path) -> int:
        """About how much memory it takes for an input, in bytes."""
        kind = FORMATS.get(source.suffix.lower())
        if kind is None or not source.is_file():
            return 0
        size = source.stat().st_size
        return PROCESS + READING * size + self.estimate(max(1, size // kind.vertex)).bytes

    def estimate(self, vertices: int) -> spectral_tv.Estimate:
        """What the flows of a mesh of so many vertices take; a subclass knows its own."""
        return spectral_tv.estimate(vertices)

    @classmethod
    def add_arguments(cls, parser: argparse.ArgumentParser) -> None:
        """Declare what it takes."""
        what = "a file with a mesh"
        add_places(parser, what, "the file", cls.example, is_required=cls.is_required)
        add_options(parser, cls.options)
        cls.add_own(parser)
        add_report(parser)

    @classmethod
    def add_own(cls, parser: argparse.ArgumentParser) -> None:
        """Declare what it takes beside its options."""

    def complaint(self) -> str | None:
        """What is wrong with the arguments together; None if nothing is."""
        choices = self.choices
        reason = complaint_of_places(choices, [("-o", choices.output)])
        reason = reason or self._complaint_of_targets()
        return reason or self.own_complaint() or complaint(choices, self.options, self.asked)

    def own_complaint(self) -> str | None:
        """What is wrong with those of the verb."""
        return None

    def holding(self) -> Sequence[str]:
        """The suffixes of what holds the result that was asked for."""
        return self.suffixes()

    def _complaint_of_targets(self) -> str | None:
        if self.choices.output is None:
            return None
        targets = [target for source in self.choices.inputs for target in self.targets(source)]
        hint = "; choose another with --format" if is_folder(self.choices.output) else ""
        for suffix in [target.suffix.lower() for target in targets]:
            if suffix not in {*writable(), *self.suffixes()}:
                return f"there is no way to write {suffix or 'files without suffix'}{hint}"
            if suffix not in self.holding():
                others = " ".join(self.holding())
                return f"{a(suffix)} does not hold {self.result}; {others} do{hint}"
        return complaint_of_clashes(self.choices, targets)

    def treat_file(self, source: Path, entry: Entry) -> None:
        """Read, treat and write a file, and say so in ``entry``."""
        target = None if self.choices.output is None else target_of(self.choices, source)
        ensure_file(source)
        if target is not None:
            ensure_writable(target.absolute())
        found = read(source)
        entry.read = {"format": source.suffix.lower(), **found.counts}
        entry.done = {"verb": self.name, "settings": self.told()}
        self.finish(found, self.treat(found, source, target, entry.done), target)
        if target is not None:
            entry.output = str(target)
            say(f"{source}: wrote {target}")

    def treat(
        self, read: Read, source: Path, target: Path | None, done: dict[str, object]
    ) -> Result:
        """Do it; what the report has to say goes into ``done``.

        Raises Refusal or spectral_tv.MeshError.
        """
        raise NotImplementedError

    def finish(self, read: Read, result: Result, target: Path | None) -> None:
        """Write what came of it."""
        if target is not None:
            write(read, result, target)
