"""The vertices and faces that a file gives, and those that Blender's importers leave out."""

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np
from spectral_tv.dataclass import dataclass
from spectral_tv.files import fbx, ply, ply_table, stl
from spectral_tv.files import obj as objs
from spectral_tv.files.faces import Faces
from spectral_tv.files.torn import last
from spectral_tv.notes import listed, note
from spectral_tv.refusal import Refusal

from ..scene.coordinates import coordinates
from ..scene.surface import NOWHERE
from .digits import FAR, OBJ_AXES, PLAIN, Digits, are_nowhere, of_points


@dataclass(frozen=True)
class Given:
    """A file as it is: how coordinates are stored, and where its vertices are, (V, 3).

    ``obj`` is what else is in an OBJ file, ``spare`` the bytes behind the end of an STL file, and
    ``faces`` those of a PLY file.
    """

    path: Path
    digits: Digits = PLAIN
    points: np.ndarray | None = None
    obj: objs.Obj | None = None
    spare: int = 0
    faces: Faces | None = None

    @property
    def has_gaps(self) -> bool:
        """Whether a vertex is nowhere."""
        return self.points is not None and bool(are_nowhere(self.points).any())

    @property
    def _is_good(self) -> bool:
        """Whether Blender reads it right."""
        has_loose = self.obj is not None and len(self.obj.loose) > 0
        # From Blender 5.2 on vertices that are not there become the first one.
        is_astray = self.faces is not None and bool(self.faces.are_outside().any())
        return not (self.digits.is_moved or self.spare or self.has_gaps or has_loose or is_astray)

    @contextmanager
    def mended(self) -> Iterator[Path]:
        """Yield a path to a file that Blender reads right: another one where it would not."""
        if self.spare:
            note(f"{self.spare} bytes after its last triangle were passed over")
        if self.digits.is_moved:
            point = self.digits.told(self.path.suffix.lower())
            note(f"its coordinates are far from 0, so it was worked on relative to {point}")
        if self._is_good:
            yield self.path
            return
        with TemporaryDirectory(prefix="spectral_tv_") as folder:
            place = Path(folder).resolve() / self.path.name  # it names objects
            self._mend(place)
            yield place

    def _mend(self, place: Path) -> None:
        assert self.points is not None
        offset = self.digits.offset
        if self.obj is not None:
            offset = OBJ_AXES @ offset
        nowhere = ~(np.abs(self.points) < NOWHERE)
        points = np.where(nowhere, FAR, self.points - offset)
        if self.obj is not None:
            _mend_obj(self.path, place, points, self.obj)
        elif self.path.suffix.lower() == ".ply":
            self._mend_ply(place, points)
        else:
            write_stl(self.path, place, points)

    def _mend_ply(self, place: Path, points: np.ndarray) -> None:
        if self.faces is not None and self.faces.are_outside().any():
            table = ply_table.read(self.path)
            table.columns |= dict(zip(ply.AXES, points.T, strict=True))
            table.faces = self.faces.only(~self.faces.are_outside())
            table.write(place, None, ())
            return
        vertices = ply.find_vertices(self.path, ply.read_header(self.path))
        assert vertices is not None
        vertices.replace(place, points)

    def compare(self, objects: Sequence[bpy.types.Object]) -> None:
        """Have vertices be nowhere that are so in the file, and note what else it had."""
        meshes = [obj.data for obj in objects if obj.type == "MESH"]
        for mesh in meshes:
            _set_nowhere(mesh)
        if self.path.suffix.lower() == ".fbx":
            _restore_gaps(meshes, fbx.shapes(self.path))
        if self.path.suffix.lower() in READERS:
            self._tell_lost(meshes)
        if self.obj is not None:
            if not self.obj.ends:
                note("its last line has no end: it may have been cut short")
            if self.obj.groups:
                # Blender ends where it reads groups and a face is in none.
                note(f"left out, as they are not read: groups of faces ({listed(self.obj.groups)})")
            _sort(objects, self.obj, self.path.stem)

    def _tell_lost(self, meshes: Sequence[bpy.types.Mesh]) -> None:
        """Note how many faces did not come in, and what is wrong with them."""
        expected = self._count()
        there = sum(len(mesh.polygons) for mesh in meshes)
        corners = sum(len(mesh.loops) for mesh in meshes)
        if expected is None or expected in ((there, corners), (there, None)):
            return
        faces = self._faces()
        faults = faces.faults() if faces is not None else []
        lost = expected[0] - there
        why = f": {'; '.join(faults)}" if faults else ""
        if lost > 0:
            note(f"{lost} of {expected[0]} faces were left out, as Blender does not read them{why}")
        elif faults:
            note(f"faces were changed, as Blender does not read them as they are{why}")

    def _count(self) -> tuple[int, int | None] | None:
        """How many faces, and corners of these, the file has, as far as it is known."""
        if self.obj is not None:
            return len(self.obj.faces.sizes), len(self.obj.faces.corners)
        if self.path.suffix.lower() == ".stl":
            return (len(self.points) // 3, None) if self.points is not None else None
        header = ply.read_header(self.path)
        face = header.element("face")
        if face is None or header.element("tristrips") is not None:
            return None
        return face.count, None

    def _faces(self) -> Faces | None:
        if self.obj is not None:
            return self.obj.faces
        if self.path.suffix.lower() == ".stl":
            return stl.faces(self.points) if self.points is not None else None
        return self.faces


def read(path: Path) -> Given:
    """Read what a .ply, .obj or .stl gives; of others nothing is known."""
    reader = READERS.get(path.suffix.lower())
    return reader(path) if reader is not None else Given(path)


def write_stl(path: Path, target: Path, points: np.ndarray) -> None:
    """Write an STL file anew with other corners, (3 T, 3)."""
    if not stl.is_text(path):
        rows = stl.triangles(path)
        rows["corners"] = points.reshape(-1, 3, 3)
        with path.open("rb") as file:
            head = file.read(stl.HEAD)
        target.write_bytes(head + rows.tobytes())
        return
    rest = iter(points.tolist())
    with path.open("rb") as source, target.open("wb") as file:
        for line in source:
            is_corner = line.split(None, 1)[:1] == [b"vertex"]
            file.write(ply.replaced(line, (1, 2, 3), next(rest)) if is_corner else line)


def _of_ply(path: Path) -> Given:
    try:
        header = ply.read_header(path)
    except ply.NoHeader:  # Blender says what is wrong
        return Given(path)
    is_text = not header.order
    vertices = ply.find_vertices(path, header)
    if vertices is None or vertices.element.count == 0:
        return Given(path, Digits(np.zeros(3), is_text, header.is_double))
    points = vertices.points()
    faces = ply_table.read_faces(path, header) if header.element("tristrips") is None else None
    return Given(path, of_points(points, is_text, header.is_double), points, faces=faces)


def _of_obj(path: Path) -> Given:
    obj = objs.read(path)
    digits = of_points(obj.points, is_text=True)
    return Given(path, Digits(digits.offset @ OBJ_AXES, is_text=True), obj.points, obj)


def _of_stl(path: Path) -> Given:
    """Raises Refusal if a binary file has not all its triangles."""
    points = stl.points(path)
    if stl.is_text(path):
        lines = last(path, 1000).splitlines() or [b""]
        if not lines[-1].strip().startswith(b"endsolid"):
            note("the file has no end: it may have been cut short")
        return Given(path, of_points(points, is_text=True), points)
    size = path.stat().st_size
    with path.open("rb") as file:
        triangles = int.from_bytes(file.read(stl.HEAD)[-4:], "little")
    if size < stl.HEAD + 50 * triangles or size < stl.HEAD:
        raise Refusal(f"the file is not whole: {size} bytes for {triangles} triangles")
    return Given(path, PLAIN, points, None, size - stl.HEAD - 50 * triangles)


READERS = {".ply": _of_ply, ".obj": _of_obj, ".stl": _of_stl}


def _mend_obj(path: Path, place: Path, points: np.ndarray, obj: objs.Obj) -> None:
    """Write an OBJ file anew with other vertices, the loose ones referred to."""
    rest = iter(points.tolist())
    loose = obj.loose_of_sections()
    section = 0
    with path.open("rb") as source, place.open("wb") as file:
        for line in objs.whole_lines(source):
            words = line.split(None, 4)
            word = words[0] if words else b""
            if word == b"v":
                file.write(ply.replaced(line, (1, 2, 3), next(rest)))
            elif word == b"mtllib" and len(words) > 1:
                file.write(_library(line, path.parent.resolve(), place.parent))
            else:
                if word == b"o":
                    file.write(objs.refer_to(loose.get(section, np.zeros(0, dtype=np.int64))))
                    section += 1
                file.write(line if line.endswith(b"\n") else line + b"\n")
        file.write(objs.refer_to(loose.get(section, np.zeros(0, dtype=np.int64))))


def _library(line: bytes, folder: Path, other: Path) -> bytes:
    """The line of an OBJ file that names its materials, as seen from another folder."""
    name = os.fsdecode(line.split(None, 1)[1].strip())
    try:
        return b"mtllib " + os.fsencode(os.path.relpath(folder / name, other)) + b"\n"
    except ValueError:  # on another drive of Windows
        return line


def _set_nowhere(mesh: bpy.types.Mesh) -> None:
    """Have coordinates be no numbers that were put far away."""
    points = coordinates(mesh.vertices)
    is_nowhere = ~(np.abs(points) < NOWHERE)
    if is_nowhere.any():
        points[is_nowhere] = np.nan
        mesh.vertices.foreach_set("co", points)
        mesh.update()


def _restore_gaps(meshes: Sequence[bpy.types.Mesh], shapes: Sequence[np.ndarray]) -> None:
    """Give vertices no finite place again if they have none in the file's shapes, (V, 3).

    Raises Refusal if it cannot be told which mesh belongs to a shape.
    """
    for shape in shapes:
        gaps = np.flatnonzero(are_nowhere(shape))
        if len(gaps) == 0:
            continue
        same = {mesh for mesh in meshes if len(mesh.vertices) == len(shape)}
        if len(same) != 1:
            raise Refusal(
                f"vertex {gaps[0]} of a mesh of {len(shape)} vertices has a coordinate that is not "
                f"finite"
            )
        (mesh,) = same
        points = coordinates(mesh.vertices).reshape(-1, 3)
        points[gaps] = np.nan
        mesh.vertices.foreach_set("co", points.ravel())
        mesh.update()


def _sort(objects: Sequence[bpy.types.Object], obj: objs.Obj, stem: str) -> None:
    """Have objects be in the order in which they are in the file, not in that of their names."""
    left = sorted(objects, key=lambda each: each.name)
    found: list[bpy.types.Object] = []
    for section in obj.sections:
        same = [each for each in left if section.drawn and _is_named(each, section.name or stem)]
        if same:
            found.append(same[0])
            left.remove(same[0])
    collection = bpy.context.scene.collection
    ordered = [each for each in found + left if each.name in collection.objects]
    for each in ordered:
        collection.objects.unlink(each)
    for each in ordered:
        collection.objects.link(each)
    bpy.context.view_layer.update()


def _is_named(obj: bpy.types.Object, name: str) -> bool:
    stem, _, number = obj.name.rpartition(".")
    return name == obj.name or (name == stem and number.isdecimal())
