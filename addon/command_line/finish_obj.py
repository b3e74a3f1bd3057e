"""Rewriting OBJ files that Blender wrote: all digits of a float, relative to 0."""

import os
from collections.abc import Iterator, Sequence
from pathlib import Path

import bpy
import numpy as np
from spectral_tv.dataclass import dataclass
from spectral_tv.files.torn import require

from ..scene.coordinates import points
from .digits import OBJ_AXES, Digits, are_coarse, are_nowhere, decimals_of, fine_decimals

# What is less than this of a matrix is rounding.
NOISE = 2e-7


def finish(path: Path, target: Path, digits: Digits, objects: Sequence[bpy.types.Object]) -> None:
    """Write an OBJ file of Blender's anew, with all digits of a float, and relative to 0.

    Raises Torn if one of the objects in it has not all of its vertices and faces.
    """
    spare = _instances()
    with path.open("rb") as source, target.open("wb") as file:
        block: list[bytes] = []
        for line in source:
            if line.startswith(b"o "):
                file.writelines(_block(block, spare, digits))
                block = []
            if line.startswith(b"mtllib "):
                block.append(b"mtllib " + os.fsencode(target.with_suffix(".mtl").name) + b"\n")
            else:
                block.append(line)
        file.writelines(_block(block, spare, digits))
    for obj in objects:
        require(not spare.get(_name(obj)), f"{obj.name} is not in it")


@dataclass(frozen=True)
class _Instance:
    """A mesh as it is seen: its vertices in the axes of the file, and how many faces it has."""

    points: np.ndarray
    faces: int


def _instances() -> dict[str, list[_Instance]]:
    """All meshes that are seen, by the names of their objects in an OBJ file."""
    found: dict[str, list[_Instance]] = {}
    for item in bpy.context.evaluated_depsgraph_get().object_instances:
        obj = item.object
        if obj.type != "MESH" or not item.show_self or not obj.data.vertices:
            continue
        matrix = np.array(item.matrix_world)
        linear, place = OBJ_AXES @ matrix[:3, :3], OBJ_AXES @ matrix[:3, 3]
        # A turn by 90° is not quite one in floats.
        linear[np.abs(linear) < NOISE * np.abs(linear).max()] = 0.0
        linear = np.where(np.abs(np.abs(linear) - 1) < NOISE, np.sign(linear), linear)
        own = points(obj.data.vertices)
        instance = _Instance(own @ linear.T + place, len(obj.data.polygons))
        found.setdefault(_name(obj), []).append(instance)
    return found


def _name(obj: bpy.types.Object) -> str:
    return obj.name.replace(" ", "_")


def _block(
    lines: list[bytes], spare: dict[str, list[_Instance]], digits: Digits
) -> Iterator[bytes]:
    """The lines of an object in an OBJ file, with all digits of its vertices."""
    name = lines[0][2:].strip().decode(errors="replace") if lines else ""
    candidates = spare.get(name)
    if not candidates:
        yield from lines
        return
    printed = [line.split() for line in lines if line.startswith(b"v ")]
    faces = sum(line.startswith(b"f ") for line in lines)
    instance = _pick(candidates, printed, faces)
    require(instance is not None, f"{name} has {len(printed)} vertices and {faces} faces")
    texts = iter(_texts(instance.points, digits))
    rest = (b"".join(b" " + word for word in words[4:]) for words in printed)
    for line in lines:
        if line.startswith(b"v "):
            yield b"v %b%b\n" % (next(texts), next(rest))
        else:
            yield line


def _pick(candidates: list[_Instance], printed: list[list[bytes]], faces: int) -> _Instance | None:
    """Take that of several objects of a name which has these vertices."""
    points = np.array([words[1:4] for words in printed]).reshape(-1, 3).astype(np.float64)
    for place, instance in enumerate(candidates):
        if len(instance.points) == len(points) and instance.faces == faces:
            is_there = ~are_nowhere(points)
            error = np.abs(instance.points - points)[is_there].max(initial=0.0)
            if error <= 1e-6 + 1e-6 * np.abs(points[is_there]).max(initial=0.0):
                return candidates.pop(place)
    return None


def _texts(points: np.ndarray, digits: Digits) -> list[bytes]:
    """Coordinates in the fewest digits that tell a float from the next."""
    if digits.is_moved:
        places = decimals_of(points)
        rows = (points + OBJ_AXES @ digits.offset).round(places).tolist()
        return [b" ".join(repr(number).encode() for number in row) for row in rows]
    if are_coarse(points) is not None:  # the object is far away, not what it holds
        rows = points.round(fine_decimals(points)).tolist()
        return [b" ".join(repr(number).encode() for number in row) for row in rows]
    rows = (points.astype(np.float32) + 0.0).astype("S16").tolist()  # −0 is 0
    return [b" ".join(row) for row in rows]
