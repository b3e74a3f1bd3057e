"""What all verbs do: read a file, treat its objects, write and picture them, one by one."""

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy
import spectral_tv

from ..scene.notes import gathered
from ..scene.objects import Refusal, refusal
from . import files, picture
from .arguments import add_arguments, complaint, epilog, outputs
from .progress import say

FAILED = 1


@dataclass(frozen=True)
class Task:
    """What an object is treated for: the file to write, if any, and how messages begin."""

    file: Path | None
    label: str


class Command:
    """A verb of the command line: says what it takes, and what it does to one file."""

    name: str
    summary: str
    description: str
    examples: str

    def add_parser(self, commands: argparse._SubParsersAction) -> None:
        """Add the verb to the command line."""
        raise NotImplementedError

    def complaint(self, choices: argparse.Namespace) -> str | None:
        """What is wrong with the arguments together; None if nothing is."""
        raise NotImplementedError

    def _treat_file(self, choices: argparse.Namespace, source: Path) -> None:
        """Do it; raises Refusal, spectral_tv.MeshError or what Blender does."""
        raise NotImplementedError

    def _run(self, choices: argparse.Namespace) -> int:
        """Treat every input, those that fail too, and return the exit code."""
        reason = self.complaint(choices)
        if reason is not None:
            choices.parser.error(reason)
        results = [self._try(choices, source) for source in choices.inputs]
        if len(results) > 1:
            say(f"{sum(results)} of {len(results)} inputs succeeded")
        return 0 if all(results) else FAILED

    def _try(self, choices: argparse.Namespace, source: Path) -> bool:
        try:
            with gathered() as notes:
                self._treat_file(choices, source)
            for note in notes:
                say(f"{source}: {note}")
        except (
            Refusal,
            spectral_tv.MeshError,
            MemoryError,
            RuntimeError,
            ValueError,
            OSError,
        ) as error:
            say(f"{source}: error: {_reason(error)}")
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

    def _treat_file(self, choices: argparse.Namespace, source: Path) -> None:
        files.load(source.absolute())
        objects = _named(choices.objects) if choices.objects else self.choose(choices)
        file, shot = outputs(choices, source)
        distinct = list({obj.data: obj for obj in reversed(objects)}.values())[::-1]
        for obj in distinct:
            reason = refusal(obj)
            if reason is not None:
                raise Refusal(f"{obj.name}: {reason}")
        for group in self.groups(distinct, choices):
            names = ", ".join(obj.name for obj in group)
            self._treat_group(group, choices, Task(file, f"{source}: {names}"))
        if file is not None:
            files.save(file.absolute(), objects if choices.objects else None)
            say(f"{source}: wrote {file}")
        if shot is not None:
            picture.render(objects, shot.absolute())
            say(f"{source}: wrote {shot}")

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


def _reason(error: Exception) -> str:
    """The message of an error in one line; Blender's own begin with a label, and may be many."""
    lines = [line.strip() for line in str(error).splitlines()]
    told = [line for line in lines if line and not line.startswith("Location:")]
    if any(line.startswith("Traceback") or "Python: Traceback" in line for line in told):
        told = told[-1:]
    return "; ".join(line.removeprefix("Error: ") for line in told) or type(error).__name__
