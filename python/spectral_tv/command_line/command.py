"""A verb of a command line: does it to one file after the other, and says what became of each."""

import argparse
import hashlib
import time
from collections.abc import Callable, Collection
from concurrent.futures import Executor
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, NoReturn

import spectral_tv
from spectral_tv.batches.batch import Batch
from spectral_tv.batches.inputs import inputs_of, share
from spectral_tv.batches.options import NAMES as BATCH
from spectral_tv.batches.options import add_batch, complaint_of_batch
from spectral_tv.command_line import errors
from spectral_tv.command_line.memory import forget_peak, peak
from spectral_tv.command_line.places import EXIT_CODES, is_folder
from spectral_tv.command_line.report import DONE, Entry, Report
from spectral_tv.command_line.signals import heed
from spectral_tv.files import whole
from spectral_tv.notes import gathered
from spectral_tv.options.arguments import names_of, read, told
from spectral_tv.refusal import Refusal

FAILED = 1
# What is no setting of a verb.
PLACES = (
    "inputs",
    "beneath",
    "output",
    "format",
    "render",
    "report",
    "objects",
    "run",
    "parser",
    "child",
    *BATCH,
)


class Command:
    """A verb of the command line, with what was chosen: does it to one file after the other."""

    name: ClassVar[str]
    summary: ClassVar[str]
    description: ClassVar[str]
    # With {program} in the place of what users begin with.
    examples: ClassVar[str]
    # The dataclass of its options, and whether those that are not given are the object's own.
    options: ClassVar[type]
    of_object: ClassVar[bool] = False
    # Whether all inputs are one work, which cannot be shared out.
    is_together: ClassVar[bool] = False

    def __init__(self, choices: argparse.Namespace) -> None:
        """Take what was chosen."""
        self.choices = choices

    @classmethod
    def add_to(
        cls,
        commands: Any,
        program: str,
        more: Callable[[Any], None] | None = None,
    ) -> None:
        """Add the verb to the command line that users begin with ``program``, with ``more``
        arguments about many files."""
        examples = cls.examples.replace("{program}", program)
        parser = commands.add_parser(
            cls.name,
            help=cls.summary,
            description=cls.description,
            epilog=f"{cls.formats()}\n\nexamples:\n{examples}\n\n{EXIT_CODES}",
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        cls.add_arguments(parser)
        group = add_batch(parser, is_together=cls.is_together)
        if more is not None and not cls.is_together:
            more(group)
        parser.set_defaults(run=cls, parser=parser)

    @staticmethod
    def formats() -> str:
        """Lines that tell what it reads and writes."""
        raise NotImplementedError

    @classmethod
    def add_arguments(cls, parser: argparse.ArgumentParser) -> None:
        """Declare what it takes."""
        raise NotImplementedError

    def complaint(self) -> str | None:
        """What is wrong with the arguments together; None if nothing is."""
        raise NotImplementedError

    @classmethod
    def reads(cls) -> Collection[str]:
        """Of files in folders, those that end so are taken."""
        raise NotImplementedError

    def is_one(self, _folder: Path) -> bool:
        """Whether a folder is one input, and not one for each file in it."""
        return False

    def targets(self, source: Path) -> list[Path]:
        """The files that are written for an input."""
        raise NotImplementedError

    def need(self, source: Path) -> int:
        """About how much memory it takes for an input, in bytes; 0 if that is not known."""
        return 0

    def treat_file(self, source: Path, entry: Entry) -> None:
        """Do it and say so in ``entry``; raises one of ERRORS."""
        raise NotImplementedError

    @cached_property
    def asked(self) -> Any:
        """The options that were chosen, in the dataclass that declares them."""
        return read(self.choices, self.options)

    def told(self) -> dict[str, Any]:
        """The settings that were chosen, or are defaults, and count."""
        others = {
            name: value
            for name, value in vars(self.choices).items()
            if name not in PLACES and value not in (None, "", [])
        }
        if self.of_object:
            return others
        own = names_of(self.options)
        return told(self.asked) | {name: each for name, each in others.items() if name not in own}

    def run(self) -> int:
        """Treat every input, those that fail too, and return the exit code."""
        try:
            return 0 if self.batch().run() else FAILED
        except Refusal as error:  # of who should do the work
            self._complain(str(error))

    def batch(self, executor: Executor | None = None, quiet: bool = False) -> Batch:
        """All inputs, and who works on them; wrong arguments are for the parser."""
        choices = self.choices
        reason = self._expand() or self.complaint() or complaint_of_batch(choices)
        if reason is not None:
            self._complain(reason)
        # All machines with a share see the same clashes.
        choices.inputs = share(choices.inputs, choices.shard)
        try:
            report = Report(choices.report)
        except OSError as error:
            self._complain(f"--report {choices.report}: {error.strerror}")
        return Batch(self, report, executor, quiet)

    def _complain(self, reason: str) -> NoReturn:
        """Have the parser say what is wrong with the arguments."""
        parser: argparse.ArgumentParser = self.choices.parser
        parser.error(reason)

    def _expand(self) -> str | None:
        """Have files stand for folders, patterns and lists; what is wrong with them."""
        choices = self.choices
        folder = choices.output if choices.output and is_folder(choices.output) else None
        try:
            found = inputs_of(choices.inputs, choices.files_from, self.reads(), folder, self.is_one)
        except Refusal as error:
            return str(error)
        choices.inputs, choices.beneath = found.files, found.beneath
        return None if found.files else "name an INPUT, or a list of them with --files-from"

    def treat_input(self, source: Path, entry: Entry) -> None:
        """Treat an input, and say in ``entry`` what became of it.

        Raises KeyboardInterrupt if the end is asked for; ``entry`` says then whether it was done.
        """
        started = time.perf_counter()
        former = None
        try:
            forget_peak()
            former = self._identities(source)
            with gathered() as entry.warnings:
                try:
                    self._prepare(source, entry)
                    self.treat_file(source, entry)
                    entry.status = DONE
                except ERRORS as error:
                    heed()
                    entry.fail(errors.reason(error))
            if hasattr(self.choices, "weld"):
                entry.warnings[:] = map(errors.in_options, entry.warnings)
            if entry.status == DONE:
                entry.messages += [f"{source}: {text}" for text in entry.warnings]
        except KeyboardInterrupt:
            if former is not None and entry.status != DONE:
                self._note_written(source, former, entry)
            raise
        finally:
            entry.seconds = round(time.perf_counter() - started, 3)
            entry.memory = peak()

    def _identities(self, source: Path) -> dict[Path, whole.Identity]:
        return {target: whole.identity(target) for target in self.targets(source)}

    def _note_written(self, source: Path, former: dict[Path, whole.Identity], entry: Entry) -> None:
        """Say that the work is done if all outputs are in place though it was interrupted.

        Else the next run would find an output that no report has.
        """
        present = self._identities(source)
        if present and all(each not in (None, former[target]) for target, each in present.items()):
            entry.status = DONE
            entry.output = entry.output or str(next(iter(present)))

    def _prepare(self, source: Path, entry: Entry) -> None:
        """Make the folders for the results of a file in a folder, and take its digest."""
        if self.choices.beneath[source].parts:
            for target in self.targets(source):
                target.parent.mkdir(parents=True, exist_ok=True)
        if source.is_file():
            with source.open("rb") as file:
                entry.digest = hashlib.file_digest(file, "sha256").hexdigest()


ERRORS = (Refusal, spectral_tv.MeshError, MemoryError, RuntimeError, ValueError, OSError)
