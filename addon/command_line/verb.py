"""What all verbs do: read each file, treat its objects, then write and picture them."""

import argparse
import time
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy
import spectral_tv

from ..files.whole import ensure_writable
from ..options.arguments import names_of, read, told
from ..scene.frames import kept, visited
from ..scene.notes import about, gathered, listed
from ..scene.objects import Refusal, refusal
from . import errors, picture
from .arguments import add_arguments, complaint, epilog, outputs
from .frames import frames_of, plays
from .load import Source, freeze, load
from .progress import say
from .report import DONE, Entry, Report
from .save import save
from .signals import heed

FAILED = 1
# What is no setting of a verb.
PLACES = ("inputs", "output", "format", "render", "report", "objects", "run", "parser")


@dataclass(frozen=True)
class Task:
    """What an object is treated for: the file to write, if any, and how messages begin."""

    file: Path | None
    label: str


@dataclass(frozen=True)
class Job:
    """An input under work: where it is, what becomes of it, what was read, and what is done."""

    source: Path
    file: Path | None
    read: Source
    done: list[list[str]]


class Command:
    """A verb of the command line: says what it takes, and what it does to one file."""

    name: str
    summary: str
    description: str
    examples: str
    # The dataclass of its options, and whether those that are not given are the object's own.
    options: type
    of_object = False

    def add_parser(self, commands: argparse._SubParsersAction) -> None:
        """Add the verb to the command line."""
        raise NotImplementedError

    def complaint(self, choices: argparse.Namespace) -> str | None:
        """What is wrong with the arguments together; None if nothing is."""
        raise NotImplementedError

    def _treat_file(self, choices: argparse.Namespace, source: Path, entry: Entry) -> None:
        """Do it and say so in ``entry``; raises one of ERRORS."""
        raise NotImplementedError

    def settings(self, choices: argparse.Namespace) -> Any:
        """The options that were chosen, in the dataclass that declares them."""
        return read(choices, self.options)

    def settings_of(self, choices: argparse.Namespace) -> dict[str, Any]:
        """The settings that were chosen, or are defaults, and count."""
        others = {
            name: value
            for name, value in vars(choices).items()
            if name not in PLACES and value not in (None, "", [])
        }
        if self.of_object:
            return others
        own = names_of(self.options)
        left = {name: value for name, value in others.items() if name not in own}
        return {**told(self.settings(choices)), **left}

    def _run(self, choices: argparse.Namespace) -> int:
        """Treat every input, those that fail too, and return the exit code."""
        reason = self.complaint(choices)
        if reason is not None:
            choices.parser.error(reason)
        try:
            report = Report(choices.report)
        except OSError as error:
            choices.parser.error(f"--report {choices.report}: {error.strerror}")
        results: list[bool] = []
        try:
            for source in choices.inputs:
                results.append(self._try(choices, source, report))
        except KeyboardInterrupt:
            for source in choices.inputs[len(results) + 1 :]:
                say(f"{source}: not begun")
            raise
        if len(results) > 1:
            say(f"{sum(results)} of {len(results)} inputs succeeded")
        return 0 if all(results) else FAILED

    def _try(self, choices: argparse.Namespace, source: Path, report: Report) -> bool:
        """Treat an input, say and report what became of it, and whether that is good."""
        entry = Entry(str(source))
        started = time.perf_counter()
        try:
            with gathered() as entry.warnings:
                try:
                    self._treat_file(choices, source, entry)
                    entry.status = DONE
                except ERRORS as error:
                    heed()
                    entry.error = errors.reason(error)
            if hasattr(choices, "weld"):
                entry.warnings[:] = map(errors.in_options, entry.warnings)
            told = entry.warnings if entry.error is None else [f"error: {entry.error}"]
            for text in told:
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
    """One about meshes: says what it takes, and what it does to objects."""

    # What objects are called that were treated.
    result: str

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Declare what it takes besides what all verbs do."""
        raise NotImplementedError

    def complaint_of_own(self, choices: argparse.Namespace) -> str | None:
        """What is wrong with these arguments together; None if nothing is."""
        raise NotImplementedError

    def complaint(self, choices: argparse.Namespace) -> str | None:
        """What is wrong with the arguments together; None if nothing is."""
        return complaint(choices) or self.complaint_of_own(choices)

    def treat(
        self, objects: Sequence[bpy.types.Object], choices: argparse.Namespace, task: Task
    ) -> None:
        """Do it to one of `groups`; raises Refusal or spectral_tv.MeshError."""
        raise NotImplementedError

    def groups(
        self, objects: list[bpy.types.Object], _choices: argparse.Namespace
    ) -> list[list[bpy.types.Object]]:
        """The objects, those together that are treated as one."""
        return [[obj] for obj in objects]

    def choose(self, _choices: argparse.Namespace) -> list[bpy.types.Object]:
        """The objects to treat where none is named; raises Refusal if there are none."""
        present = bpy.context.view_layer.objects
        meshes = [obj for obj in present if obj.type == "MESH" and len(obj.data.polygons) > 0]
        if not meshes:
            raise Refusal("there is no mesh with faces in it")
        return meshes

    def add_parser(self, commands: argparse._SubParsersAction) -> None:
        """Add the verb to the command line."""
        parser = commands.add_parser(
            self.name,
            help=self.summary,
            description=self.description,
            epilog=epilog(self.examples),
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        add_arguments(parser, self.name, self.result)
        self.add_arguments(parser)
        parser.set_defaults(run=self._run, parser=parser)

    def _treat_file(self, choices: argparse.Namespace, source: Path, entry: Entry) -> None:
        file, shot = outputs(choices, source)
        for target in filter(None, (file, shot)):
            ensure_writable(target.absolute())
        found = load(source.absolute())
        objects = _named(choices.objects) if choices.objects else self.choose(choices)
        entry.read = _described(found)
        distinct = list({obj.data: obj for obj in reversed(objects)}.values())[::-1]
        for obj in distinct:
            reason = refusal(obj)
            if reason is not None:
                raise Refusal(f"{obj.name}: {reason}")
        entry.done = {"verb": self.name, "settings": self.settings_of(choices), "objects": []}
        self.treat_all(distinct, choices, Job(source, file, found, entry.done["objects"]))
        only = objects if choices.objects else None
        if file is not None:
            entry.output = self.write(file, only, choices, found)
            for path in [entry.output] if isinstance(entry.output, str) else entry.output:
                say(f"{source}: wrote {path}")
        if shot is not None:
            picture.render(objects, shot.absolute())
            entry.picture = str(shot)
            say(f"{source}: wrote {shot}")

    def treat_all(
        self, objects: list[bpy.types.Object], choices: argparse.Namespace, job: "Job"
    ) -> None:
        """Treat objects that do not share meshes, as they are in the current frame."""
        freeze(job.read, "")
        self.treat_groups(objects, choices, job)

    def write(
        self,
        file: Path,
        only: Sequence[bpy.types.Object] | None,
        choices: argparse.Namespace,
        read: Source,
    ) -> str | list[str]:
        """Write the file, or one for each frame if it cannot play them, and tell the names."""
        if choices.frames is None or plays(file):
            save(file.absolute(), only, read)
            return str(file)
        written = []
        scene = bpy.context.scene
        with kept(scene):
            for frame in visited(scene, frames_of(choices.frames, read)):
                path = file.with_stem(f"{file.stem}_{frame:04d}")
                save(path.absolute(), only, read)
                written.append(str(path))
        return written

    def treat_groups(
        self,
        objects: list[bpy.types.Object],
        choices: argparse.Namespace,
        job: "Job",
        label: str = "",
    ) -> None:
        """Treat objects, those of a group together."""
        groups = self.groups(objects, choices)
        for group in groups:
            names = [obj.name for obj in group]
            task = Task(job.file, f"{job.source}: {listed(names)}{label}")
            with about(listed(names)) if len(groups) > 1 else nullcontext():
                self._treat_group(group, choices, task)
            if names not in job.done:
                job.done.append(names)

    def _treat_group(
        self, objects: Sequence[bpy.types.Object], choices: argparse.Namespace, task: Task
    ) -> None:
        try:
            self.treat(objects, choices, task)
        except (Refusal, spectral_tv.MeshError, MemoryError) as error:
            raise Refusal(f"{objects[0].name}: {error}") from error


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
