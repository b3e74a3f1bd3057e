"""What all verbs do: read each file, treat its objects, then write and picture them."""

import argparse
import time
from collections.abc import Sequence
from contextlib import nullcontext
from functools import cached_property
from pathlib import Path
from typing import Any

import bpy
import spectral_tv
from spectral_tv.command_line import errors
from spectral_tv.command_line.progress import say
from spectral_tv.command_line.report import DONE, Entry, Report
from spectral_tv.command_line.signals import heed
from spectral_tv.files.whole import ensure_writable
from spectral_tv.notes import about, gathered, listed
from spectral_tv.options.arguments import names_of, read, told
from spectral_tv.refusal import Refusal

from ..scene.frames import kept, visited
from ..scene.objects import refusal
from . import picture
from .arguments import EXIT_CODES, add_arguments, complaint, outputs
from .formats import exportable, importable
from .frames import frames_of, plays
from .load import Source, freeze, load
from .save import save

FAILED = 1
# What is no setting of a verb.
PLACES = ("inputs", "output", "format", "render", "report", "objects", "run", "parser")


class Command:
    """A verb of the command line, with what was chosen: does it to one file after the other."""

    name: str
    summary: str
    description: str
    examples: str
    # The dataclass of its options, and whether those that are not given are the object's own.
    options: type
    of_object = False

    def __init__(self, choices: argparse.Namespace) -> None:
        """Take what was chosen."""
        self.choices = choices

    @classmethod
    def add_to(cls, commands: argparse._SubParsersAction) -> None:
        """Add the verb to the command line."""
        parser = commands.add_parser(
            cls.name,
            help=cls.summary,
            description=cls.description,
            epilog=f"{cls.formats()}\n\nexamples:\n{cls.examples}\n\n{EXIT_CODES}",
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

    def _treat_file(self, source: Path, entry: Entry) -> None:
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
                    self._treat_file(source, entry)
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


class Verb(Command):
    """One about meshes.

    Of the input under work it knows the ``source``, the ``file`` to write, if any, what was
    ``read``, the names of the objects that were treated, those together that were one, and what
    was ``measured`` of them.
    """

    # What is done to objects, if its name does not say it, and what they are then.
    does = ""
    result: str
    source: Path
    file: Path | None
    read: Source
    done: list[list[str]]
    # What was measured of objects, by their names, for the report.
    measured: dict[str, Any]

    @staticmethod
    def formats() -> str:
        """Lines that tell what it reads and writes."""
        return f"reads:  {' '.join(importable())}\nwrites: {' '.join(exportable())}"

    @classmethod
    def add_arguments(cls, parser: argparse.ArgumentParser) -> None:
        """Declare what it takes; a subclass adds its own."""
        add_arguments(parser, cls.does or cls.name, cls.result)

    def complaint(self) -> str | None:
        """What is wrong with the arguments together; a subclass looks at its own."""
        return complaint(self.choices)

    def treat(self, objects: Sequence[bpy.types.Object], label: str) -> None:
        """Do it to one of `groups`; messages begin with ``label``.

        Raises Refusal or spectral_tv.MeshError.
        """
        raise NotImplementedError

    def groups(self, objects: list[bpy.types.Object]) -> list[list[bpy.types.Object]]:
        """The objects, those together that are treated as one."""
        return [[obj] for obj in objects]

    def choose(self) -> list[bpy.types.Object]:
        """The objects to treat where none is named; raises Refusal if there are none."""
        present = bpy.context.view_layer.objects
        meshes = [obj for obj in present if obj.type == "MESH" and len(obj.data.polygons) > 0]
        if not meshes:
            raise Refusal("there is no mesh with faces in it")
        return meshes

    def _treat_file(self, source: Path, entry: Entry) -> None:
        self.source, names = source, self.choices.objects
        self.file, shot = outputs(self.choices, source)
        for target in filter(None, (self.file, shot)):
            ensure_writable(target.absolute())
        self.read = load(source.absolute())
        objects = _named(names) if names else self.choose()
        entry.read = _described(self.read)
        distinct = list({obj.data: obj for obj in reversed(objects)}.values())[::-1]
        for obj in distinct:
            reason = refusal(obj)
            if reason is not None:
                raise Refusal(f"{obj.name}: {reason}")
        self.done, self.measured = [], {}
        entry.done = {"verb": self.name, "settings": self.told(), "objects": self.done}
        self.treat_all(distinct)
        if self.measured:
            entry.done["deviation"] = self.measured
        if self.file is not None:
            entry.output = self.write(objects if names else None)
            for path in [entry.output] if isinstance(entry.output, str) else entry.output:
                say(f"{source}: wrote {path}")
        if shot is not None:
            picture.render(objects, shot.absolute())
            entry.picture = str(shot)
            say(f"{source}: wrote {shot}")

    def treat_all(self, objects: list[bpy.types.Object]) -> None:
        """Treat objects that do not share meshes, as they are in the current frame."""
        freeze(self.read, "")
        self.treat_groups(objects)

    def write(self, only: Sequence[bpy.types.Object] | None) -> str | list[str]:
        """Write the file, or one for each frame if it cannot play them, and tell the names."""
        asked = self.choices.frames
        if asked is None or plays(self.file):
            save(self.file.absolute(), only, self.read)
            return str(self.file)
        written = []
        scene = bpy.context.scene
        with kept(scene):
            for frame in visited(scene, frames_of(asked, self.read)):
                path = self.file.with_stem(f"{self.file.stem}_{frame:04d}")
                save(path.absolute(), only, self.read)
                written.append(str(path))
        return written

    def treat_groups(self, objects: list[bpy.types.Object], frame: str = "") -> None:
        """Treat objects, those of a group together; messages name the ``frame``."""
        groups = self.groups(objects)
        for group in groups:
            names = [obj.name for obj in group]
            with about(listed(names)) if len(groups) > 1 else nullcontext():
                try:
                    self.treat(group, f"{self.source}: {listed(names)}{frame}")
                except (Refusal, spectral_tv.MeshError, MemoryError) as error:
                    raise Refusal(f"{group[0].name}: {error}") from error
            if names not in self.done:
                self.done.append(names)


def _named(names: list[str]) -> list[bpy.types.Object]:
    present = bpy.context.view_layer.objects
    for name in names:
        if name not in present:
            raise Refusal(f"there is no object {name!r} in it")
    return [present[name] for name in dict.fromkeys(names)]


def _described(read: Source) -> dict[str, Any]:
    """What was read, for the report."""
    meshes = [obj for obj in bpy.context.view_layer.objects if obj.type == "MESH"]
    objects = [
        {"name": obj.name, "vertices": len(obj.data.vertices), "faces": len(obj.data.polygons)}
        for obj in meshes
    ]
    digits = read.digits
    return {
        "format": read.suffix,
        "objects": objects,
        "vertices": sum(obj["vertices"] for obj in objects),
        "faces": sum(obj["faces"] for obj in objects),
        "frames": [read.frames[0], read.frames[-1]] if read.frames else None,
        "units": dict(read.units),
        "digits": {
            "text": digits.is_text,
            "double": digits.is_double,
            "offset": digits.offset.tolist() if digits.is_moved else None,
        },
    }
