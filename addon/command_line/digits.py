"""Coordinates with more digits than a float of Blender holds, such as those of scans in maps.

A file of text, or one of doubles, is read relative to a round point near its middle; what is
written is relative to 0 again. Text is written with all digits of a float.
"""

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

from ..files import ply
from ..files.checks.torn import require
from ..scene.coordinates import coordinates

# Relative to the size of the shape, the coarsest steps between floats that are good enough.
COARSEST = 1e-5
# So many vertices at most decide at once that a file does not need it.
PROBE = 1000
# How OBJ files see Blender's axes.
OBJ_AXES = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
# What is less than this of a matrix is rounding.
NOISE = 2e-7


@dataclass(frozen=True)
class Digits:
    """How a file stores coordinates: as text, in double precision, and relative to what.

    ``offset`` (3,) is in Blender's axes, to be added to what Blender holds.
    """

    offset: np.ndarray
    is_text: bool = False
    is_double: bool = False

    @property
    def is_moved(self) -> bool:
        """Whether Blender holds coordinates relative to another point than 0."""
        return bool(self.offset.any())

    def told(self, suffix: str) -> str:
        """The offset in the axes of files of a suffix, as the user reads it."""
        turned = OBJ_AXES @ self.offset if suffix == ".obj" else self.offset
        return "({:.12g}, {:.12g}, {:.12g})".format(*(turned + 0.0))


PLAIN = Digits(np.zeros(3))


def of_file(path: Path) -> Digits:
    """How the coordinates in a .ply, .obj or .stl are stored, and what they should be read from."""
    match path.suffix.lower():
        case ".ply":
            return _of_ply(path)
        case ".obj":
            return Digits(_offset(_numbers(path, b"v")) @ OBJ_AXES, is_text=True)
        case ".stl" if is_text_stl(path):
            return Digits(_offset(_numbers(path, b"vertex")), is_text=True)
    return PLAIN


def is_text_stl(path: Path) -> bool:
    """Whether an STL file is one of text; there are binary ones that begin like it."""
    with path.open("rb") as file:
        head = file.read(1024)
    return head.lstrip().startswith(b"solid") and (b"facet" in head or b"endsolid" in head)


def _of_ply(path: Path) -> Digits:
    try:
        header = ply.read_header(path)
    except ply.NoHeader:  # Blender says what is wrong
        return PLAIN
    is_text = not header.order
    vertices = ply.find_vertices(path, header)
    offset = np.zeros(3)
    if vertices is not None and (is_text or header.is_double):
        points = vertices.read(path)
        offset = _offset([(points, 1e-9 if is_text else 0.0)])
    return Digits(offset, is_text, header.is_double)


def _numbers(path: Path, word: bytes) -> Iterator[tuple[np.ndarray, float]]:
    """Coordinates in the lines of a file of text that begin with a word, some at a time.

    With them comes the place of their last decimal.
    """
    with path.open("rb") as file:
        some: list[list[bytes]] = []
        for line in file:
            parts = line.split(None, 4)
            if len(parts) > 3 and parts[0] == word:
                some.append(parts[1:4])
                if len(some) == PROBE:
                    yield _floats(some), _last_place(some)
                    some = []
        if some:
            yield _floats(some), _last_place(some)


def _floats(rows: list[list[bytes]]) -> np.ndarray:
    try:
        return np.array(rows).reshape(-1, 3).astype(np.float64)
    except ValueError:  # Blender says what is wrong
        return np.full((len(rows), 3), np.nan)


def _last_place(rows: list[list[bytes]]) -> float:
    return 10.0 ** -max(len(word.partition(b".")[2]) for row in rows for word in row)


def _offset(parts: Iterable[tuple[np.ndarray, float]]) -> np.ndarray:
    """A round point near the middle of points; 0 where floats from there are as good.

    With the points comes the smallest step that they tell apart, 0 if that is a double's.
    """
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    fits = True
    for points, step in parts:
        low, high = np.fmin(low, points.min(axis=0)), np.fmax(high, points.max(axis=0))
        size = float(np.linalg.norm(high - low))
        largest = float(np.abs([low, high]).max())
        spacing = float(np.spacing(np.float32(largest)))
        if not np.isfinite(spacing) or spacing <= COARSEST * size:
            return np.zeros(3)
        exact = bool((points == points.astype(np.float32)).all())
        fits = fits and (exact if step == 0 else spacing <= step)
    if fits:  # a float holds all of them
        return np.zeros(3)
    unit = 10.0 ** np.floor(np.log10(max(float(np.linalg.norm(high - low)), 1e-30)))
    return np.round((low + high) / 2 / unit) * unit


def centred(path: Path, digits: Digits, target: Path) -> None:
    """Write a file anew, relative to its offset."""
    match path.suffix.lower():
        case ".ply":
            vertices = ply.find_vertices(path, ply.read_header(path))
            assert vertices is not None
            vertices.move(path, target, -digits.offset)
        case ".obj":
            _move_text(path, target, b"v", -(OBJ_AXES @ digits.offset))
        case ".stl":
            _move_text(path, target, b"vertex", -digits.offset)


def _move_text(
    path: Path, target: Path, word: bytes, offset: np.ndarray, decimals: int | None = None
) -> None:
    """Write a file of text anew, with something added to the coordinates."""
    with path.open("rb") as source, target.open("wb") as file:
        for line in source:
            parts = line.split(None, 4)
            if len(parts) > 3 and parts[0] == word:
                file.write(ply.moved(line, (1, 2, 3), offset, decimals))
            elif len(parts) > 1 and parts[0] == b"mtllib":
                file.write(_library(line, path.parent.resolve(), target.parent))
            else:
                file.write(line)


def _library(line: bytes, folder: Path, other: Path) -> bytes:
    """The line of an OBJ file that names its materials, as seen from another folder."""
    name = os.fsdecode(line.split(None, 1)[1].strip())
    try:
        return b"mtllib " + os.fsencode(os.path.relpath(folder / name, other)) + b"\n"
    except ValueError:  # on another drive of Windows
        return line


def decimals_of(points: np.ndarray) -> int:
    """How many decimals floats of this size have."""
    largest = max(float(np.abs(points).max(initial=0.0)), 1e-30)
    return int(np.clip(np.ceil(-np.log10(np.spacing(np.float32(largest)))), 0, 17))


def finish_ply(path: Path, digits: Digits, comments: Sequence[bytes]) -> None:
    """Write a PLY file of Blender's anew: with doubles, relative to 0, and with comments."""
    header = ply.read_header(path)
    vertices = ply.find_vertices(path, header)
    if vertices is not None and (digits.is_moved or digits.is_double):
        places = decimals_of(vertices.read(path)) if digits.is_moved else None
        vertices.move(path, path, digits.offset, places)
    if comments:
        head, mark, rest = path.read_bytes().partition(b"element ")
        path.write_bytes(head + b"".join(line + b"\n" for line in comments) + mark + rest)


def finish_stl(path: Path, digits: Digits) -> None:
    """Write an STL file of text anew, relative to 0."""
    target = path.with_stem(f"{path.stem}_moved")
    points = np.concatenate([np.zeros((1, 3)), *(some for some, _ in _numbers(path, b"vertex"))])
    _move_text(path, target, b"vertex", digits.offset, decimals_of(points))
    os.replace(target, path)


def finish_obj(
    path: Path, target: Path, digits: Digits, objects: Sequence[bpy.types.Object]
) -> None:
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
        own = coordinates(obj.data.vertices).reshape(-1, 3).astype(np.float64)
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
    points = _floats([words[1:4] for words in printed])
    for place, instance in enumerate(candidates):
        if len(instance.points) == len(points) and instance.faces == faces:
            error = np.abs(instance.points - points).max(initial=0.0)
            if error <= 1e-6 + 1e-6 * np.abs(points).max(initial=0.0):
                return candidates.pop(place)
    return None


def _texts(points: np.ndarray, digits: Digits) -> list[bytes]:
    """Coordinates in the fewest digits that tell a float from the next."""
    if digits.is_moved:
        places = decimals_of(points)
        rows = (points + OBJ_AXES @ digits.offset).round(places).tolist()
        return [b" ".join(repr(number).encode() for number in row) for row in rows]
    rows = (points.astype(np.float32) + 0.0).astype("S16").tolist()  # −0 is 0
    return [b" ".join(row) for row in rows]
