"""Reading files by their suffix, with whatever operators this Blender has."""

import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any

import bpy
import numpy as np

from ..files import ply
from ..files.checks import Torn, check
from ..files.checks.torn import last
from ..scene.animation import curves_of
from ..scene.coordinates import coordinates
from ..scene.notes import listed, note
from ..scene.objects import Refusal
from ..scene.shape_keys import SLIDER_RANGE
from . import digits
from .arguments import ensure_file
from .contents import Thing, has_moving_shape, images, survey
from .digits import Digits
from .formats import BLEND, FORMATS, call, importable
from .units import units_of

# Blender cuts longer paths off; bytes.
LONGEST_PATH = 1000
# What Blender reads in part, or does not survive, where it was cut short.
CHECKED = (".ply", ".glb", ".abc", ".usdc", ".usdz")
# Where a .blend keeps what its coordinates are relative to.
OFFSET = "spectral_tv_offset"
PLY_ELEMENTS = {"vertex", "face", "edge", "tristrips"}


@dataclass(frozen=True)
class Source:
    """A file that was read, and what has to be known of it to write one alike.

    ``keys`` are the names of the shape keys that objects came with; ``frames`` those over which
    vertices move by themselves. ``units`` are for the user to read, and ``options`` those of the
    exporter that give the same units and axes. ``comments`` and ``has_normals`` are a PLY file's.
    """

    path: Path
    digits: Digits
    things: list[Thing]
    keys: Mapping[str, set[str]]
    frames: range | None = None
    units: Mapping[str, Any] = field(default_factory=dict)
    options: Mapping[str, Any] = field(default_factory=dict)
    comments: tuple[bytes, ...] = ()
    has_normals: bool = False

    @property
    def suffix(self) -> str:
        """The suffix of the file, in small letters."""
        return self.path.suffix.lower()


def load(path: Path) -> Source:
    """Open a .blend, or import another file into an empty scene.

    Raises Refusal or RuntimeError if it cannot be read.
    """
    suffix = path.suffix.lower()
    _ensure_readable(path, suffix)
    read = digits.of_file(path)
    if suffix == BLEND:
        read = _open(path)
    else:
        # The preferences, and with them this extension, stay.
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        with _mended(path, read) as place:
            _import(place, suffix)
    objects = list(bpy.context.view_layer.objects)
    _tell_missing(objects)
    units, options = units_of(path)
    comments, has_normals = _of_ply(path) if suffix == ".ply" else ((), False)
    return Source(
        path,
        read,
        survey(objects, suffix),
        {obj.name: _keys(obj) for obj in objects},
        _frames(objects),
        units,
        options,
        comments,
        has_normals,
    )


def freeze(source: Source, hint: str) -> None:
    """Keep the current frame of shapes that move, as what is played would undo every filter.

    ``hint`` tells what option takes all frames.
    """
    if source.frames is None:
        return
    moving = [obj for obj in bpy.context.view_layer.objects if has_moving_shape(obj)]
    told = (
        f"vertices of {listed(obj.name for obj in moving)} move over the frames "
        f"{source.frames[0]} to {source.frames[-1]}"
    )
    if source.suffix == BLEND:
        note(f"{told}, by modifiers{hint}")
        return
    for obj in moving:
        _freeze(obj)
    bpy.context.view_layer.update()
    frame = bpy.context.scene.frame_current
    note(f"{told}: frame {frame} alone was taken{hint}")


def _freeze(obj: bpy.types.Object) -> None:
    graph = bpy.context.evaluated_depsgraph_get()
    seen = coordinates(obj.evaluated_get(graph).data.vertices)
    if len(seen) == 3 * len(obj.data.vertices):
        obj.data.vertices.foreach_set("co", seen)
        obj.data.update()
    for modifier in list(obj.modifiers):
        if modifier.type == "MESH_SEQUENCE_CACHE":
            obj.modifiers.remove(modifier)


def _open(path: Path) -> Digits:
    bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False)
    if bpy.context.object is not None and bpy.context.object.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    return Digits(np.array(bpy.context.scene.get(OFFSET, (0.0, 0.0, 0.0)), dtype=np.float64))


def _import(path: Path, suffix: str) -> None:
    form = FORMATS[suffix]
    with _attributes_in_order() if suffix in (".glb", ".gltf") else nullcontext():
        if not call(form.importer, filepath=str(path), **form.reading):
            raise Refusal("Blender cannot import it")
    actions = [action.frame_range for action in bpy.data.actions]
    scene = bpy.context.scene
    if actions and suffix in (".glb", ".gltf", ".fbx"):  # the others set them themselves
        scene.frame_start = int(np.floor(min(start for start, _ in actions)))
        scene.frame_end = int(np.ceil(max(end for _, end in actions)))
    for keys in bpy.data.shape_keys:
        curves = list(curves_of(keys) or ())
        for key in keys.key_blocks if curves else ():
            # The importer of USD leaves room from 0 to 1 alone.
            key.slider_min, key.slider_max = SLIDER_RANGE
    if suffix == ".abc":  # at the first frame
        scene.frame_set(scene.frame_start)
    elif suffix.startswith(".usd"):
        scene.frame_set(max(scene.frame_start, min(scene.frame_current, scene.frame_end)))
    bpy.context.view_layer.update()


def _ensure_readable(path: Path, suffix: str) -> None:
    """Raise Refusal if there is no file that this Blender can read."""
    ensure_file(path)
    if suffix not in importable():
        raise Refusal(f"this Blender reads no {suffix or 'files without suffix'}")
    if path.stat().st_size == 0:
        raise Refusal("the file is empty")
    if len(os.fsencode(path)) > LONGEST_PATH:
        raise Refusal(f"its path is longer than {LONGEST_PATH} bytes, which Blender does not read")
    if suffix in CHECKED:
        try:
            check(path)
        except Torn as error:
            raise Refusal(f"the file is not whole: {error}") from error


@contextmanager
def _mended(path: Path, read: Digits) -> Iterator[Path]:
    """Yield a path to a file that Blender reads right: another one where it would not."""
    spare = _spare(path) if path.suffix.lower() == ".stl" else 0
    if not read.is_moved and not spare:
        yield path
        return
    with TemporaryDirectory(prefix="spectral_tv_") as folder:
        place = Path(folder).resolve() / path.name  # it names objects
        if spare:
            note(f"{spare} bytes after its last triangle were passed over")
            with path.open("rb") as file, place.open("wb") as copy:
                shutil.copyfileobj(file, copy)
                copy.truncate(path.stat().st_size - spare)
        else:
            point = read.told(path.suffix.lower())
            note(f"its coordinates are far from 0, so it was worked on relative to {point}")
            digits.centred(path, read, place)
        yield place


def _spare(path: Path) -> int:
    """How many bytes there are after the last triangle of a binary STL file.

    Raises Refusal if there are fewer than there should be.
    """
    size = path.stat().st_size
    if digits.is_text_stl(path):
        lines = last(path, 1000).splitlines() or [b""]
        if not lines[-1].strip().startswith(b"endsolid"):
            note("the file has no end: it may have been cut short")
        return 0
    with path.open("rb") as file:
        triangles = int.from_bytes(file.read(84)[80:], "little")
    if size < 84 + 50 * triangles or size < 84:
        raise Refusal(f"the file is not whole: {size} bytes for {triangles} triangles")
    return size - 84 - 50 * triangles


def _tell_missing(objects: list[bpy.types.Object]) -> None:
    """Note which textures are not where the file says."""
    materials = {slot.material for obj in objects for slot in obj.material_slots if slot.material}
    for image in {image for material in materials for image in images(material.node_tree)}:
        if image.source == "FILE" and image.packed_file is None:
            place = Path(bpy.path.abspath(image.filepath, library=image.library))
            if not place.is_file():
                note(f"there is no texture {place}")


def _keys(obj: bpy.types.Object) -> set[str]:
    keys = obj.data.shape_keys if obj.type == "MESH" else None
    return {key.name for key in keys.key_blocks} if keys is not None else set()


def _frames(objects: list[bpy.types.Object]) -> range | None:
    """The frames over which vertices move by themselves; None if they do not."""
    if not any(has_moving_shape(obj) for obj in objects):
        return None
    scene = bpy.context.scene
    return range(scene.frame_start, scene.frame_end + 1)


def _of_ply(path: Path) -> tuple[tuple[bytes, ...], bool]:
    """The comments of a PLY file, and whether vertices have normals; notes what is not read."""
    header = ply.read_header(path)
    lost = [element.name for element in header.elements if element.name not in PLY_ELEMENTS]
    for element in header.elements:
        own = [item.name for item in element.properties]
        if element.name == "face":
            lost += [f"{name} of faces" for name in own if not name.startswith("vertex_ind")]
        elif element.name == "vertex":
            lists = [item.name for item in element.properties if item.count is not None]
            lost += [f"{name} of vertices" for name in lists]
    if lost:
        note(f"left out, as Blender does not read them: {listed(lost)}")
    vertex = header.element("vertex")
    names = {item.name for item in vertex.properties} if vertex is not None else set()
    comments = tuple(line for line in header.comments if not line.startswith(BLENDERS_COMMENT))
    return comments, {"nx", "ny", "nz"} <= names


BLENDERS_COMMENT = b"comment Created in Blender"


class _Ordered(dict[str, None]):
    """A set that keeps the order in which things were added to it."""

    def __init__(self, items: Any = ()) -> None:
        super().__init__(dict.fromkeys(items))

    def update(self, items: Any) -> None:
        super().update(dict.fromkeys(items))


@contextmanager
def _attributes_in_order() -> Iterator[None]:
    """Have Blender's importer of glTF not mix up custom attributes.

    It goes through a set of their names, in another order every time, and through a list of their
    values at once.
    """
    module = ModuleType("absent")
    for name in ("gltf2_blender_mesh", "mesh"):  # up to Blender 4.2, and since
        with suppress(ImportError):
            module = import_module(f"io_scene_gltf2.blender.imp.{name}")
    vars(module)["set"] = _Ordered
    try:
        yield
    finally:
        del vars(module)["set"]
