"""What all verbs do: read each file, treat its objects, then write and picture them."""

import argparse
from collections.abc import Collection, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import bpy
import spectral_tv
from spectral_tv.command_line.command import Command
from spectral_tv.command_line.progress import say
from spectral_tv.command_line.report import Entry
from spectral_tv.files.numbered import numbered
from spectral_tv.files.whole import ensure_writable
from spectral_tv.notes import about, listed
from spectral_tv.refusal import Refusal

from ..scene.frames import kept, visited
from ..scene.objects import refusal
from . import picture
from .arguments import add_arguments, complaint, outputs
from .formats import exportable, importable
from .frames import frames_of, plays
from .load import Source, freeze, load
from .save import save


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
    # Whether vertices come and go over frames.
    is_remeshed = False
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

    @classmethod
    def reads(cls) -> Collection[str]:
        """Of files in folders, those that end so are taken."""
        return importable()

    def targets(self, source: Path) -> list[Path]:
        """The file and the picture that are written for an input."""
        return [path for path in outputs(self.choices, source) if path is not None]

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

    def treat_file(self, source: Path, entry: Entry) -> None:
        """Read it, treat its objects, write and picture them, and say so in ``entry``."""
        self.source, names = source, self.choices.objects
        self.file, shot = outputs(self.choices, source)
        for target in filter(None, (self.file, shot)):
            ensure_writable(target.absolute())
        self.read = self.load(source.absolute())
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

    def load(self, source: Path) -> Source:
        """Read an input; raises Refusal or RuntimeError."""
        return load(source)

    def treat_all(self, objects: list[bpy.types.Object]) -> None:
        """Treat objects that do not share meshes, as they are in the current frame."""
        freeze(self.read, "")
        self.treat_groups(objects)

    def write(self, only: Sequence[bpy.types.Object] | None) -> str | list[str]:
        """Write the file, or one for each frame if it cannot play them, and tell the names."""
        asked = self.choices.frames
        if asked is None or plays(self.file, is_remeshed=self.is_remeshed):
            save(self.file.absolute(), only, self.read)
            return str(self.file)
        written = []
        scene = bpy.context.scene
        with kept(scene):
            for frame in visited(scene, frames_of(asked, self.read)):
                path = numbered(self.file, frame)
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
