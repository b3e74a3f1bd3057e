"""Caches of moving vertices in files, and the modifiers that play them.

An Alembic file holds any motion. A PC2 file ("point cache", of 3ds Max) holds that of vertices that
stay, and is read by Blenders without Alembic too.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
from spectral_tv.files.names import file_keys
from spectral_tv.files.room import with_room
from spectral_tv.files.whole import written
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

from ..command_line.alembic import alembic_size
from ..command_line.formats import FORMATS, call
from ..command_line.writing import written_by_blender
from ..scene.playing import play_meshes, take_apart
from ..scene.temporary import Temporary

ALEMBIC, PC2 = ".abc", ".pc2"
NAME = "Filtered Frames"
# The head of a PC2 file: its mark, version, vertices, first frame, frames per sample, samples.
HEAD = "<12siiffi"


def usual_suffix() -> str:
    """That of caches of this Blender."""
    return ALEMBIC if FORMATS[ALEMBIC].exporter else PC2


def target_of(obj: bpy.types.Object, filepath: str) -> Path:
    """The file that a cache of ``obj`` is written to: the one named, or one beside the .blend.

    Raises Refusal if there is no place for it.
    """
    saved = bpy.data.filepath
    if not saved and (not filepath or filepath.startswith("//")):
        raise Refusal("save the .blend first, or choose a file for the cache elsewhere")
    if not filepath:
        name = bpy.path.clean_name(obj.name)
        return _free(Path(saved).with_name(f"{Path(saved).stem}_{name}{usual_suffix()}"))
    target = Path(bpy.path.abspath(filepath))
    suffix = target.suffix.lower()
    if suffix == ALEMBIC and not FORMATS[ALEMBIC].exporter:
        raise Refusal("this Blender writes no Alembic; name the cache .pc2")
    if suffix not in (ALEMBIC, PC2):
        raise Refusal(f"a cache is an .abc or a .pc2, not {target.name!r}")
    if not target.parent.is_dir():
        raise Refusal(f"there is no folder {target.parent}")
    return target


def ensure_holds(target: Path, *, keeps_vertices: bool) -> None:
    """Raise Refusal if such a file cannot hold the frames."""
    if target.suffix.lower() == PC2 and not keeps_vertices:
        hint = "" if usual_suffix() == PC2 else "; name the cache .abc"
        raise Refusal(f"its vertices are others on other frames, which no .pc2 holds{hint}")


def write_moving(
    target: Path, obj: bpy.types.Object, shapes: Sequence[np.ndarray], frames: range
) -> None:
    """Write the mesh of ``obj`` in the shapes (V, 3) of the frames; raises NotWritten."""
    if target.suffix.lower() == PC2:
        with written(target) as place:
            _write_pc2(place, shapes, frames)
        return
    with TemporaryDirectory(prefix="spectral_tv_") as folder, Temporary() as now:
        points = Path(folder) / f"points{PC2}"
        _write_pc2(points, shapes, frames)
        now.callback(obj.modifiers.clear)
        _add_pc2(obj, str(points), frames)
        _export(target, obj, alembic_size([obj.data]), frames)


def write_meshes(
    target: Path, obj: bpy.types.Object, meshes: Sequence[bpy.types.Mesh], frames: range
) -> None:
    """Write a mesh of each frame as an Alembic file, and remove them; raises NotWritten."""
    with ExitStack() as stack:
        most = max(alembic_size([mesh]) for mesh in meshes)
        stack.callback(take_apart, play_meshes(obj, meshes, frames))
        _export(target, obj, most, frames)


def add_cache(obj: bpy.types.Object, target: Path, frames: range) -> None:
    """Have ``obj`` play a cache that was written of it; raises Refusal if it cannot be read."""
    path = str(target)
    if bpy.data.filepath and target.drive == Path(bpy.data.filepath).drive:
        path = bpy.path.relpath(path)
    if target.suffix.lower() == PC2:
        _add_pc2(obj, path, frames)
        return
    before = set(bpy.data.cache_files)
    call("cachefile.open", filepath=str(target))
    made = set(bpy.data.cache_files) - before
    if not made:
        raise Refusal(f"Blender cannot read {target}")
    (cache,) = made
    try:
        modifier = obj.modifiers.new(NAME, "MESH_SEQUENCE_CACHE")
        modifier.cache_file = cache
        bpy.context.view_layer.update()  # which reads what is in it
        (held,) = cache.object_paths
        modifier.object_path = held.path
        cache.filepath = path
    except BaseException:
        obj.modifiers.clear()
        bpy.data.cache_files.remove(cache)
        raise


def _free(target: Path) -> Path:
    """The file, or one of another number if this one is read in the .blend."""
    caches = [cache.filepath for cache in bpy.data.cache_files if cache.users]
    modifiers = [item for obj in bpy.data.objects for item in obj.modifiers]
    caches += [item.filepath for item in modifiers if item.type == "MESH_CACHE"]
    used = set(file_keys([Path(bpy.path.abspath(each)) for each in caches]))
    found, number = target, 1
    while file_keys([found])[0] in used:
        number += 1
        found = target.with_stem(f"{target.stem}_{number}")
    return found


def _write_pc2(place: Path, shapes: Sequence[np.ndarray], frames: range) -> None:
    head = struct.pack(HEAD, b"POINTCACHE2", 1, len(shapes[0]), frames[0], 1, len(shapes))
    with place.open("wb") as file:
        file.write(head)
        for shape in shapes:
            file.write(np.ascontiguousarray(shape, dtype="<f4").tobytes())


def _add_pc2(obj: bpy.types.Object, path: str, frames: range) -> None:
    modifier = obj.modifiers.new(NAME, "MESH_CACHE")
    modifier.cache_format, modifier.filepath = "PC2", path
    modifier.frame_start = frames[0]


def _export(target: Path, obj: bpy.types.Object, most: int, frames: range) -> None:
    chosen = {**FORMATS[ALEMBIC].options, "selected": True, "flatten": True}
    chosen |= {"start": frames[0], "end": frames[-1], "visible_objects_only": False}
    with ExitStack() as stack:
        place = stack.enter_context(written_by_blender(target))
        # A disk that gets full would end the process.
        path = stack.enter_context(with_room(place, most * len(frames)))
        stack.enter_context(_alone(obj))
        if not call(FORMATS[ALEMBIC].exporter, filepath=str(path), check_existing=False, **chosen):
            raise Refusal(f"Blender could not write {target}")


@contextmanager
def _alone(obj: bpy.types.Object) -> Iterator[None]:
    """Have an object be selected alone."""
    layer = bpy.context.view_layer
    with Temporary() as now:
        for other in layer.objects:
            now.callback(other.select_set, other.select_get())
            other.select_set(other == obj)
        layer.update()
        yield
