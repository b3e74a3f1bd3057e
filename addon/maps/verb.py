"""``map``: files in, maps over UVs out."""

import argparse
from collections.abc import Collection
from dataclasses import replace
from functools import cached_property
from pathlib import Path

import bpy
from spectral_tv.command_line.command import Command
from spectral_tv.command_line.places import (
    add_places,
    add_report,
    complaint_of_clashes,
    complaint_of_places,
    is_folder,
    target_of,
)
from spectral_tv.command_line.progress import progress, say
from spectral_tv.command_line.report import Entry
from spectral_tv.files.whole import ensure_writable
from spectral_tv.notes import listed
from spectral_tv.options.arguments import add_arguments as add_options
from spectral_tv.options.arguments import read
from spectral_tv.refusal import Refusal

from ..command_line.formats import importable
from ..command_line.load import freeze, load
from ..scene.objects import refusal
from ..scene.records import record_of
from . import files
from .baking import bake
from .settings import MapSettings
from .telling import told


class BakeMap(Command):
    """Bakes what bands do, or a surface, to maps."""

    name = "map"
    summary = "bake looks and bands to maps over UVs"
    description = """\
Bake the look of an object, or a band, to a map over its UVs, or over those of a low-poly mesh in
the same file, by Cycles.

A .blend has the bands and their values. Over the UVs of another object, any file will do: the look
of an object without bands is its surface."""
    examples = """\
  {program} map look.blend -o height.exr
  {program} map look.blend -o vectors.exr --kind tangent --onto LowPoly --size 4096
  {program} map scan.glb -o normals.png --kind normal --object Scan --onto LowPoly"""
    options = MapSettings

    @staticmethod
    def formats() -> str:
        """Lines that tell what it reads and writes."""
        return f"reads:  {' '.join(importable())}\nwrites: {' '.join(files.FORMATS)}"

    @classmethod
    def add_arguments(cls, parser: argparse.ArgumentParser) -> None:
        """Declare what it takes."""
        add_places(
            parser, "a file that Blender imports", "the map", "png", is_required=True, default="exr"
        )
        add = parser.add_argument
        add(
            "--object",
            metavar="NAME",
            dest="objects",
            help="bake this object; the only one with bands, or the only other one, if not given",
        )
        add("--onto", metavar="NAME", help="over the UVs of this object, instead of its own")
        add_options(parser, MapSettings)
        add_report(parser)

    @classmethod
    def reads(cls) -> Collection[str]:
        """Of files in folders, those that end so are taken."""
        return importable()

    def targets(self, source: Path) -> list[Path]:
        """The map that is written for an input."""
        choices = self.choices
        target = target_of(choices, source)
        if is_folder(choices.output) and choices.format is None:
            target = target.with_suffix(files.EXR)
        return [target]

    def complaint(self) -> str | None:
        """What is wrong with the arguments together; None if nothing is."""
        choices = self.choices
        reason = complaint_of_places(choices, [("-o", choices.output)])
        targets = [self.targets(source)[0] for source in choices.inputs]
        for target in targets:
            reason = reason or files.suffix_refusal(target, self.asked)
        return reason or complaint_of_clashes(choices, targets, is_replaced=False)

    @cached_property
    def asked(self) -> MapSettings:
        """The options that were chosen."""
        found: MapSettings = read(self.choices, MapSettings)
        return found if self.choices.onto is None else replace(found, onto="OTHER")

    def treat_file(self, source: Path, entry: Entry) -> None:
        """Read it, bake and write the map, and say so in ``entry``."""
        (target,) = self.targets(source)
        ensure_writable(target.absolute())
        found = load(source.absolute())
        entry.read = {"format": found.suffix}
        freeze(found, "")
        bpy.context.view_layer.update()
        other = None if self.choices.onto is None else _named(self.choices.onto)
        obj = self._object(other)
        entry.done = {"verb": self.name, "settings": self.told(), "objects": [[obj.name]]}
        with progress(f"{source}: {obj.name}") as show:
            baked = bake(obj, other, self.asked, show)
        files.write(target.absolute(), baked)
        entry.output = str(target)
        say(f"{source}: {obj.name}: {told(baked, self.asked, target)}")

    def _object(self, other: bpy.types.Object | None) -> bpy.types.Object:
        """The object to bake; raises Refusal if it is not clear which one."""
        if self.choices.objects is not None:
            return _named(self.choices.objects)
        present = [obj for obj in bpy.context.view_layer.objects if obj.type == "MESH"]
        found = [obj for obj in present if record_of(obj) is not None and obj != other]
        found = found or [obj for obj in present if obj != other]
        if len(found) != 1:
            names = f" of {listed(obj.name for obj in found)}" if found else ", as there is none"
            raise Refusal(f"name the object to bake with --object{names}")
        return found[0]


def _named(name: str) -> bpy.types.Object:
    obj = bpy.context.view_layer.objects.get(name)
    if obj is None:
        raise Refusal(f"there is no object {name!r} in it")
    reason = refusal(obj, override=True)
    if reason is not None:
        raise Refusal(f"{name}: {reason}")
    return obj
