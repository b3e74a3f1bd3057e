"""A verb of a command line: does it to one file after the other, and says what became of each."""

import argparse
import time
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import spectral_tv
from spectral_tv.command_line import errors
from spectral_tv.command_line.places import EXIT_CODES
from spectral_tv.command_line.progress import say
from spectral_tv.command_line.report import DONE, Entry, Report
from spectral_tv.command_line.signals import heed
from spectral_tv.notes import gathered
from spectral_tv.options.arguments import names_of, read, told
from spectral_tv.refusal import Refusal

FAILED = 1
# What is no setting of a verb.
PLACES = ("inputs", "output", "format", "render", "report", "objects", "run", "parser")


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

    def __init__(self, choices: argparse.Namespace) -> None:
        """Take what was chosen."""
        self.choices = choices

    @classmethod
    def add_to(cls, commands: Any, program: str) -> None:
        """Add the verb to the command line that users begin with ``program``."""
        examples = cls.examples.replace("{program}", program)
        parser = commands.add_parser(
            cls.name,
            help=cls.summary,
            description=cls.description,
            epilog=f"{cls.formats()}\n\nexamples:\n{examples}\n\n{EXIT_CODES}",
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        cls.add_arguments(parser)
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
        choices = self.choices
        reason = self.complaint()
        if reason is not None:
            choices.parser.error(reason)
        try:
            report = Report(choices.report)
        except OSError as error:
            choices.parser.error(f"--report {choices.report}: {error.strerror}")
        results: list[bool] = []
        try:
            for source in choices.inputs:
                results.append(self._try(source, report))
        except KeyboardInterrupt:
            for source in choices.inputs[len(results) + 1 :]:
                say(f"{source}: not begun")
            raise
        if len(results) > 1:
            say(f"{sum(results)} of {len(results)} inputs succeeded")
        return 0 if all(results) else FAILED

    def _try(self, source: Path, report: Report) -> bool:
        """Treat an input, say and report what became of it, and whether that is good."""
        entry = Entry(str(source))
        started = time.perf_counter()
        try:
            with gathered() as entry.warnings:
                try:
                    self.treat_file(source, entry)
                    entry.status = DONE
                except ERRORS as error:
                    heed()
                    entry.error = errors.reason(error)
            if hasattr(self.choices, "weld"):
                entry.warnings[:] = map(errors.in_options, entry.warnings)
            for text in entry.warnings if entry.error is None else [f"error: {entry.error}"]:
                say(f"{source}: {text}")
        except KeyboardInterrupt:
            if entry.status != DONE:
                entry.error = "interrupted"
                say(f"{source}: {entry.error}")
            raise
        finally:
            entry.seconds = round(time.perf_counter() - started, 3)
            is_reported = _record(report, entry)
        heed()
        return entry.status == DONE and is_reported


ERRORS = (Refusal, spectral_tv.MeshError, MemoryError, RuntimeError, ValueError, OSError)


def _record(report: Report, entry: Entry) -> bool:
    """Add a line to the report, whatever comes between; False if it cannot be written."""
    try:
        try:
            report.add(entry)
        except KeyboardInterrupt:
            report.add(entry)
            raise
    except OSError as error:
        say(f"{entry.input}: error: {error}")
        return False
    return True
