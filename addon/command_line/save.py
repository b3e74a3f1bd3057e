"""Writing files by their suffix, whole, and noting what the formats do not hold."""

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
from spectral_tv.notes import a, listed, note
from spectral_tv.refusal import Refusal

from ..scene.temporary import Temporary
from .contents import armatures
from .copies import unhooked
from .exports import Export, is_text, write
from .formats import BLEND, FORMATS, call
from .load import LONGEST_PATH, OFFSET, Source
from .losses import tell_losses
from .metres import tell_units
from .nowhere import left_out, tell_kept
from .writing import written_by_blender

USD = (".usd", ".usda", ".usdc", ".usdz")


def save(path: Path, only: Sequence[bpy.types.Object] | None, source: Source) -> None:
    """Write the scene, or the objects ``only`` of it, in the format of the path's suffix.

    A .blend always holds everything. What was read from ``source`` and is not in the file is
    noted. Raises NotWritten or Refusal if it cannot be written.
    """
    suffix = path.suffix.lower()
    if suffix == BLEND:
        tell_kept(bpy.context.view_layer.objects)
        with written_by_blender(path) as place:
            _write_blend(place, source)
        return
    with _exported(only) as objects, left_out(objects, suffix):
        names = {obj.name for obj in objects}
        things = [thing for thing in source.things if thing.owner in names]
        tell_losses(things, suffix, source.suffix)
        tell_units(suffix)
        read = source.digits
        if read.is_moved and not _holds_offset(suffix, source):
            note(f"{a(suffix)} stays relative to {read.told(source.suffix)}")
        form = FORMATS[suffix]
        options = {**form.options, form.selection: form.by_selection or only is not None}
        if _is_alike(suffix, source.suffix):
            options |= source.options
        with written_by_blender(path, with_others=form.others) as place:
            _ensure_short(place)
            write(place, Export(path, suffix, objects, source, options))


def _holds_offset(suffix: str, source: Source) -> bool:
    """Whether coordinates are written relative to 0, with all their digits."""
    return suffix in (".ply", ".obj") or (suffix == ".stl" and is_text(suffix, source))


def _is_alike(suffix: str, other: str) -> bool:
    return suffix == other or {suffix, other} <= set(USD)


def _write_blend(place: Path, source: Source) -> None:
    _ensure_short(place)
    if source.digits.is_moved:
        bpy.context.scene[OFFSET] = source.digits.offset.tolist()
    try:
        _save(place)
    except RuntimeError:
        _ensure_room(place)
        raise


def _save(place: Path) -> None:
    call("wm.save_as_mainfile", filepath=str(place), check_existing=False, copy=True)


def _ensure_room(place: Path) -> None:
    """Raise the disk's own error if no .blend can be written there; Blender may name another cause.

    The file is written on another disk first, and copied if that succeeds.
    """
    with TemporaryDirectory(prefix="spectral_tv_") as folder:
        other = Path(folder) / place.name
        try:
            _save(other)
            content = other.read_bytes()
        except (OSError, RuntimeError):
            return
    with place.open("wb") as file:
        file.write(content)
        os.fsync(file.fileno())
    place.unlink()  # its relative paths are those of another folder


def _ensure_short(place: Path) -> None:
    if len(os.fsencode(place)) > LONGEST_PATH:
        raise Refusal(f"its path is longer than {LONGEST_PATH} bytes, which Blender does not write")


@contextmanager
def _exported(only: Sequence[bpy.types.Object] | None) -> Iterator[list[bpy.types.Object]]:
    """Yield the objects that will be in a file: those that are shown, or the given ones.

    Armatures that move them are shown meanwhile, as exporters leave out what is hidden.
    """
    layer = bpy.context.view_layer
    layer.update()
    wanted = [obj for obj in layer.objects if obj.visible_get()] if only is None else list(only)
    if only is None:
        rigs = {item.object for obj in wanted for item in armatures(obj)}
        wanted += [obj for obj in layer.objects if obj in rigs and obj not in wanted]
        hidden = [obj.name for obj in layer.objects if obj not in wanted]
        if hidden:
            note(f"hidden, and so not in the file: {listed(hidden)}")
    with Temporary() as now:
        now.callback(layer.update)
        for obj in layer.objects:
            now.callback(setattr, obj, "hide_viewport", obj.hide_viewport)
            now.callback(obj.hide_set, obj.hide_get())
            now.callback(obj.select_set, obj.select_get())
            obj.select_set(False)
        for obj in wanted:
            obj.hide_viewport = False
            obj.hide_set(False)
            obj.select_set(True)
        layer.update()
        left = [obj.name for obj in wanted if not obj.visible_get()]
        if only is not None and left:
            raise Refusal(f"{left[0]} is in a hidden collection, so it cannot be exported alone")
        off = [item for obj in wanted for item in obj.modifiers if not item.show_viewport]
        with unhooked(off):
            yield [obj for obj in wanted if obj.name not in left]
