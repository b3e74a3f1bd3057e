"""``decompose``: files in, bands or filtered shapes out."""

import argparse
from pathlib import Path

import bpy
import spectral_tv

from ..bands import add_bands, prepare, set_values
from ..objects import Refusal, refusal
from ..settings import Settings
from . import files, picture
from .arguments import add_arguments, band_values, complaint, outputs, settings
from .progress import progress, say

FAILED = 1


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Add the sub-command to the command line."""
    parser = commands.add_parser("decompose", help="split meshes into bands of detail")
    add_arguments(parser)
    parser.set_defaults(run=run, parser=parser)


def run(choices: argparse.Namespace) -> int:
    """Treat every input, those that fail too, and return the exit code."""
    reason = complaint(choices)
    if reason is not None:
        choices.parser.error(reason)
    results = [_try(choices, source) for source in choices.inputs]
    if len(results) > 1:
        say(f"{sum(results)} of {len(results)} inputs succeeded")
    return 0 if all(results) else FAILED


def _try(choices: argparse.Namespace, source: Path) -> bool:
    try:
        _treat(choices, source)
    except (Refusal, spectral_tv.MeshError, RuntimeError, ValueError, OSError) as error:
        say(f"{source}: error: {_reason(error)}")
        return False
    return True


def _treat(choices: argparse.Namespace, source: Path) -> None:
    files.load(source.absolute())
    objects = _chosen(choices.objects)
    asked, values = settings(choices), band_values(choices)
    treated = set()
    for obj in objects:
        if obj.data not in treated:  # objects may share a mesh
            treated.add(obj.data)
            _decompose(obj, asked, values, f"{source}: {obj.name}")
    file, shot = outputs(choices, source)
    if file is not None:
        files.save(file.absolute(), objects if choices.objects else None)
        say(f"{source}: wrote {file}")
    if shot is not None:
        picture.render(objects, shot.absolute())
        say(f"{source}: wrote {shot}")


def _chosen(names: list[str] | None) -> list[bpy.types.Object]:
    """The objects of the scene to decompose."""
    present = bpy.context.view_layer.objects
    if names is None:
        meshes = [obj for obj in present if obj.type == "MESH" and len(obj.data.polygons) > 0]
        if not meshes:
            raise Refusal("there is no mesh with faces in it")
        return meshes
    for name in names:
        if name not in present:
            raise Refusal(f"there is no object {name!r} in it")
    return [present[name] for name in dict.fromkeys(names)]


def _decompose(obj: bpy.types.Object, asked: Settings, values: list[float], label: str) -> None:
    reason = refusal(obj)
    if reason is not None:
        raise Refusal(f"{obj.name}: {reason}")
    try:
        surface, arguments = prepare(obj, asked)
        with progress(label) as show:
            split = spectral_tv.decompose(surface.mesh, **arguments, progress=show)
        add_bands(obj, asked, surface, arguments, split)
    except (Refusal, spectral_tv.MeshError) as error:
        raise Refusal(f"{obj.name}: {error}") from error
    set_values(obj, values)


def _reason(error: Exception) -> str:
    """The message of an error in one line; Blender's own begin with a label, and may be many."""
    lines = [line.strip() for line in str(error).splitlines()]
    told = [line for line in lines if line and not line.startswith("Location:")]
    if any(line.startswith("Traceback") or "Python: Traceback" in line for line in told):
        told = told[-1:]
    return "; ".join(line.removeprefix("Error: ") for line in told) or type(error).__name__
