"""The file of a map: which one it is, and writing it."""

from __future__ import annotations

from pathlib import Path

import bpy
from spectral_tv.files.checks import check
from spectral_tv.files.room import with_room
from spectral_tv.files.whole import NotWritten, ensure_writable
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

from ..command_line.writing import written_by_blender
from ..scene.raw_scene import raw_scene
from ..scene.temporary import Temporary
from .baking import Map
from .settings import KINDS, NORMAL, MapSettings

EXR, PNG = ".exr", ".png"
# By suffix: the format, its bits, and how far off a value of the file may be.
FORMATS = {EXR: ("OPEN_EXR", "32", 0.0), PNG: ("PNG", "16", 1 / 65535)}
# What a pixel takes at most, and a picture beside its pixels, bytes.
PIXEL, REST = 16, 1 << 20
# What default names of files call the kinds.
NAMES = {kind: kind.lower() for kind, _, _ in KINDS} | {
    "TANGENT": "vector_tangent", "OBJECT": "vector_object"
}  # fmt: skip


def target_of(obj: bpy.types.Object, filepath: str, asked: MapSettings) -> Path:
    """The file that a map of ``obj`` is written to: the one named, or one beside the .blend.

    Raises Refusal if there is no place for it.
    """
    saved = bpy.data.filepath
    if not saved and (not filepath or filepath.startswith("//")):
        raise Refusal("save the .blend first, or choose a file for the map elsewhere")
    if filepath:
        target = Path(bpy.path.abspath(filepath)).absolute()
    else:
        what = "look" if asked.source == "LOOK" else f"band_{asked.band}"
        stem = f"{Path(saved).stem}_{bpy.path.clean_name(obj.name)}_{what}_{NAMES[asked.kind]}"
        target = Path(saved).with_name(stem + EXR)
    reason = suffix_refusal(target, asked)
    if reason is not None:
        raise Refusal(reason)
    if not target.parent.is_dir():
        raise Refusal(f"there is no folder {target.parent}")
    try:
        ensure_writable(target)
    except NotWritten as error:
        raise Refusal(str(error)) from error
    return target


def suffix_refusal(target: Path, asked: MapSettings) -> str | None:
    """Why a file of that name cannot hold the map; None if it can."""
    suffix = target.suffix.lower()
    if suffix not in FORMATS:
        return f"a map is an .exr, or a .png of normals, not {target.name!r}"
    if suffix == PNG and asked.kind != NORMAL:
        return "displacements are floats, negative ones too, which no .png holds; name it .exr"
    return None


def write(target: Path, baked: Map) -> None:
    """Write a map as floats, or of normals as 16 bits, and make sure of it; raises NotWritten."""
    most = REST + PIXEL * baked.values[..., 0].size
    with written_by_blender(target) as path, with_room(path, most) as place:
        _save(place, baked.values.astype(np.float32))


def _save(place: Path, values: np.ndarray) -> None:
    """Save colors (side, side, 3); raises RuntimeError if the file does not hold them."""
    name, bits, most = FORMATS[place.suffix.lower()]
    side = len(values)
    colors = np.ones((side, side, 4), dtype=np.float32)
    colors[..., :3] = values
    with raw_scene(name, bits) as scene, Temporary() as now:
        image = now.made(
            bpy.data.images.new("Map", side, side, alpha=False, float_buffer=True, is_data=True)
        )
        image.pixels.foreach_set(colors.ravel())
        settings = scene.render.image_settings
        settings.color_mode = "RGB"
        settings.linear_colorspace_settings.name = image.colorspace_settings.name
        image.save_render(str(place), scene=scene)
    check(place)
    with Temporary() as now:
        image = now.made(bpy.data.images.load(str(place)))
        image.colorspace_settings.is_data = True
        if tuple(image.size) != (side, side):
            raise RuntimeError("Blender cannot read it again")
        found = np.empty(side * side * 4, dtype=np.float32)
        image.pixels.foreach_get(found)
    off = np.abs(found.reshape(side, side, 4)[..., :3] - values).max()
    if not off <= most:
        raise RuntimeError(f"it holds other values than it should, by {off:.2g}")
