"""Reading files by their suffix, with whatever operators this Blender has."""

import os
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from dataclasses import field
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from spectral_tv.command_line.places import ensure_file
from spectral_tv.dataclass import dataclass
from spectral_tv.files import ply
from spectral_tv.files.checks import Torn, check
from spectral_tv.notes import listed, note
from spectral_tv.refusal import Refusal

from ..scene.animation import curves_of
from ..scene.coordinates import coordinates, points
from ..scene.mix import keys_of
from ..scene.shape_keys import SLIDER_RANGE
from . import given as files
from .contents import Thing, has_moving_shape, images, survey
from .digits import Digits, are_coarse
from .finish_ply import Exact, Look
from .formats import BLEND, FORMATS, call, importable
from .gltf_reading import read_right
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
    """A file that was read, and what is needed to write another one like it.

    ``keys`` are the names of the shape keys that the file's objects have. ``frames`` are the frames
    over which vertices move by themselves. ``units`` are for the user to read. ``options`` are
    those of the exporter that give the same units and axes. ``ply`` is the form of a PLY file.
    """

    path: Path
    digits: Digits
    things: list[Thing]
    keys: Mapping[str, set[str]]
    frames: Sequence[int] | None = None
    units: Mapping[str, Any] = field(default_factory=dict)
    options: Mapping[str, Any] = field(default_factory=dict)
    ply: Look | None = None

    @property
    def suffix(self) -> str:
        """The suffix of the file, in small letters."""
        return self.path.suffix.lower()


def load(path: Path) -> Source:
    """Open a .blend, or import another file into an empty scene.

    Raises Refusal or RuntimeError if it cannot be read.
    """
    suffix = path.suffix.lower()
    ensure_readable(path, suffix)
    given = files.read(path)
    read = given.digits
    if suffix == BLEND:
        read = _open(path)
    else:
        # The preferences, and with them this extension, stay.
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        with given.mended() as place:
            import_file(place, suffix)
        given.compare(list(bpy.context.view_layer.objects))
    objects = list(bpy.context.view_layer.objects)
    _tell_coarse(objects)
    _tell_missing(objects)
    units, options = units_of(path)
    return Source(
        path,
        read,
        survey(objects, suffix),
        {obj.name: set(keys_of(obj.data).keys()) for obj in objects if obj.type == "MESH"},
        _frames(objects),
        units,
        options,
        _of_ply(path, _exact(given, objects)) if suffix == ".ply" else None,
    )


def freeze(source: Source, hint: str) -> None:
    """Keep the current frame of shapes that move, as their motion would undo every filter.

    ``hint`` tells which option takes all frames.
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


def import_file(path: Path, suffix: str) -> None:
    """Import a file into the present scene; raises Refusal or RuntimeError."""
    form = FORMATS[suffix]
    with read_right() if suffix in (".glb", ".gltf") else nullcontext():
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


def ensure_readable(path: Path, suffix: str) -> None:
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


def _tell_coarse(objects: list[bpy.types.Object]) -> None:
    """Note which meshes are too far from 0 for floats to hold details of them."""
    for mesh, obj in {obj.data: obj for obj in objects if obj.type == "MESH"}.items():
        step = are_coarse(points(mesh.vertices))
        if step is not None:
            note(
                f"{obj.name} is so far from 0 that its coordinates are in steps of {step:.2g}, and "
                "so is the result; move it near 0, or use a .ply or .obj"
            )


def _exact(given: files.Given, objects: list[bpy.types.Object]) -> Exact | None:
    """The vertices of a PLY file with all their digits, and as Blender holds them."""
    meshes = [obj.data for obj in objects if obj.type == "MESH"]
    if len(meshes) != 1 or given.points is None or len(meshes[0].vertices) != len(given.points):
        return None
    held = points(meshes[0].vertices)
    return Exact(given.points, held)


def _tell_missing(objects: list[bpy.types.Object]) -> None:
    """Note which textures are not where the file says."""
    materials = {slot.material for obj in objects for slot in obj.material_slots if slot.material}
    for image in {image for material in materials for image in images(material.node_tree)}:
        if image.source == "FILE" and image.packed_file is None:
            place = Path(bpy.path.abspath(image.filepath, library=image.library))
            if not place.is_file():
                note(f"there is no texture {place}")


def _frames(objects: list[bpy.types.Object]) -> range | None:
    """The frames over which vertices move by themselves; None if they do not."""
    if not any(has_moving_shape(obj) for obj in objects):
        return None
    scene = bpy.context.scene
    return range(scene.frame_start, scene.frame_end + 1)


def _of_ply(path: Path, exact: Exact | None) -> Look:
    """What a PLY file is like; notes what is not read."""
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
    names = frozenset(item.name for item in vertex.properties) if vertex is not None else ()
    comments = tuple(line for line in header.comments if not line.startswith(BLENDERS_COMMENT))
    return Look(header.format, comments, frozenset(names), exact)


BLENDERS_COMMENT = b"comment Created in Blender"
