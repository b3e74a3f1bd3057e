"""Reading a folder of numbered files as an object that plays them."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import bpy
from spectral_tv.files.numbered import Numbered
from spectral_tv.notes import gathered, note
from spectral_tv.refusal import Refusal

from ..scene.playing import play_meshes
from . import given as files
from .digits import Digits
from .formats import BLEND, importable
from .load import Source, ensure_readable, import_file, load


def load_frames(folder: Path, frames: list[int] | None) -> Source:
    """Import numbered files of a folder, one mesh each: those of some frames, or all.

    Raises Refusal or RuntimeError if one cannot be read.
    """
    chosen = Numbered.of(folder, importable()).chosen(frames)
    numbers, paths = [*chosen], [*chosen.values()]
    if paths[0].suffix.lower() == BLEND:
        raise Refusal("the files of frames are meshes, and no .blend")
    told: dict[str, str] = {}
    with _named(paths[0], told):
        source = load(paths[0])
        obj = _only(list(bpy.context.view_layer.objects))
    meshes = [obj.data]
    for path in paths[1:]:
        with _named(path, told):
            meshes.append(_mesh(path, source.digits))
    for text, name in told.items():
        note(f"{name}: {text}")
    if len(meshes) > 1:
        play_meshes(obj, meshes, numbers)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = numbers[0], numbers[-1]
    scene.frame_set(numbers[0])
    return replace(source, frames=numbers)


def _mesh(path: Path, digits: Digits) -> bpy.types.Mesh:
    """The mesh of a file, with coordinates relative to what those of the first file are."""
    suffix = path.suffix.lower()
    ensure_readable(path, suffix)
    given = files.read(path)
    if given.digits.is_moved or digits.is_moved:
        given = replace(given, digits=replace(given.digits, offset=digits.offset))
    before = set(bpy.context.view_layer.objects)
    with given.mended() as place:
        import_file(place, suffix)
    made = [each for each in bpy.context.view_layer.objects if each not in before]
    given.compare(made)
    mesh = _only(made).data
    bpy.data.batch_remove(made)
    return mesh


def _only(objects: list[bpy.types.Object]) -> bpy.types.Object:
    meshes = [obj for obj in objects if obj.type == "MESH"]
    if len(meshes) != 1:
        raise Refusal(f"it has {len(meshes)} meshes; the file of a frame has one")
    return meshes[0]


@contextmanager
def _named(path: Path, told: dict[str, str]) -> Iterator[None]:
    """Say in errors which file they are about; keep notes with the first file that they are of."""
    try:
        with gathered() as notes:
            yield
    except Refusal as error:
        raise Refusal(f"{path.name}: {error}") from error
    for text in notes:
        told.setdefault(text, path.name)
