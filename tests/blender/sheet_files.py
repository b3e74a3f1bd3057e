"""A bumpy sheet in files written number by number, and what becomes of them."""

from __future__ import annotations

import re
import struct
from pathlib import Path

import numpy as np
import pytest
from command_line_files import empty, run
from spectral_tv.files import ply

ALL_PASS = ["--gain", "all=1", "--bands", "1", "--steps", "2"]
ORDERS = {"": "ascii", "<": "binary_little_endian", ">": "binary_big_endian"}


@pytest.fixture(autouse=True)
def leave_an_empty_file():
    yield
    empty()


def grid(side: int = 6) -> tuple[np.ndarray, np.ndarray]:
    """Vertices of a bumpy sheet, shuffled, and its triangles."""
    rng = np.random.default_rng(0)
    x, y = (axis.ravel() for axis in np.meshgrid(np.arange(float(side)), np.arange(float(side))))
    points = np.column_stack([x, y, np.sin(x) * np.cos(y)]) + rng.normal(0, 0.05, (side**2, 3))
    corner = np.arange(side**2).reshape(side, side)[:-1, :-1].ravel()
    lower = np.column_stack([corner, corner + 1, corner + side + 1])
    upper = np.column_stack([corner, corner + side + 1, corner + side])
    place = rng.permutation(side**2)
    shuffled = np.empty_like(points)
    shuffled[place] = points
    return shuffled, place[np.vstack([lower, upper])]


def write_ply(path: Path, points, faces, order="", kind="float", **columns) -> Path:
    """A PLY file with further columns of vertices, floats but for those of bytes."""
    letters = {"float": "f", "double": "d"}
    more = {name: np.asarray(values) for name, values in columns.items()}
    kinds = {name: "uchar" if more[name].dtype == np.uint8 else "float" for name in more}
    head = ["ply", f"format {ORDERS[order]} 1.0", f"element vertex {len(points)}"]
    head += [f"property {kind} {axis}" for axis in "xyz"]
    head += [f"property {kinds[name]} {name}" for name in more]
    head += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    text = "".join(f"{line}\n" for line in head).encode()
    rows = [
        (*map(float, point), *(values[place].item() for values in more.values()))
        for place, point in enumerate(points)
    ]
    if order:
        layout = (
            order
            + 3 * letters[kind]
            + "".join("B" if k == "uchar" else "f" for k in kinds.values())
        )
        body = b"".join(struct.pack(layout, *row) for row in rows)
        body += b"".join(struct.pack(f"{order}B{len(f)}i", len(f), *f) for f in faces)
    else:
        lines = [" ".join(map(repr, row)) for row in rows]
        lines += [" ".join(map(str, (len(face), *face))) for face in faces]
        body = "".join(f"{line}\n" for line in lines).encode()
    path.write_bytes(text + body)
    return path


def write_obj(path: Path, points, faces) -> Path:
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in np.asarray(points, dtype=float).tolist()]
    lines += ["f " + " ".join(str(corner + 1) for corner in face) for face in faces]
    path.write_text("\n".join([*lines, ""]))
    return path


def write_stl(path: Path, points, faces, is_text: bool) -> Path:
    corners = np.asarray(points, dtype=float)[np.asarray(faces)]
    if is_text:
        lines = ["solid sheet"]
        for triangle in corners.tolist():
            lines += ["facet normal 0 0 1", " outer loop"]
            lines += ["  vertex {!r} {!r} {!r}".format(*corner) for corner in triangle]
            lines += [" endloop", "endfacet"]
        path.write_text("\n".join([*lines, "endsolid sheet", ""]))
    else:
        rows = [struct.pack("<12fH", *[0] * 3, *triangle.ravel(), 0) for triangle in corners]
        path.write_bytes(bytes(80) + struct.pack("<I", len(rows)) + b"".join(rows))
    return path


WRITERS = {
    "text.ply": write_ply,
    "little.ply": lambda path, *shape: write_ply(path, *shape, "<"),
    "double.ply": lambda path, *shape: write_ply(path, *shape, ">", "double"),
    "double_text.ply": lambda path, *shape: write_ply(path, *shape, "", "double"),
    "sheet.obj": write_obj,
    "text.stl": lambda path, *shape: write_stl(path, *shape, True),
    "binary.stl": lambda path, *shape: write_stl(path, *shape, False),
}  # fmt: skip


def points_of(path: Path) -> np.ndarray:
    """The vertices of a .ply or .obj in their order, in double precision."""
    if path.suffix == ".ply":
        return ply.find_vertices(path, ply.read_header(path)).points()
    rows = re.findall(r"^v (\S+) (\S+) (\S+)", path.read_text(), re.MULTILINE)
    return np.array(rows).astype(float)


def told(path: Path, target: Path, capfd, *options: str, code: int = 0) -> str:
    capfd.readouterr()
    assert run(["decompose", str(path), "-o", str(target), *ALL_PASS, *options]) == code
    return capfd.readouterr().err
