"""The units, the axes and the vertices of an FBX file, which Blender's importer does not tell."""

import re
import struct
from importlib import import_module
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

# The settings stand before the objects.
READ = 1 << 20
NAMES = {"UpAxis": "i", "UpAxisSign": "i", "FrontAxis": "i", "FrontAxisSign": "i",
         "UnitScaleFactor": "d"}  # fmt: skip


def metadata(path: Path) -> dict[str, float]:
    """What the file says of its axes, and how many centimetres its unit has."""
    with path.open("rb") as file:
        data = file.read(READ)
    is_binary = data.startswith(b"Kaydara FBX Binary")
    found = {}
    for name, kind in NAMES.items():
        value = _binary(data, name, kind) if is_binary else _text(data, name)
        if value is not None:
            found[name] = value
    return found


def _binary(data: bytes, name: str, kind: str) -> float | None:
    # A name, its type, its label and its flags are words with their lengths before them.
    word = rb"S.\0\0\0[^\0]*?"
    mark = b"S" + struct.pack("<I", len(name)) + name.encode()
    code = {"i": b"I", "d": b"D"}[kind]
    size = struct.calcsize(kind)
    pattern = re.escape(mark) + word + word + rb"S.\0\0\0[^\0]*?" + code + b"(.{%d})" % size
    found = re.search(pattern, data, re.DOTALL)
    return float(struct.unpack(f"<{kind}", found[1])[0]) if found else None


def _text(data: bytes, name: str) -> float | None:
    pattern = rb'P:\s*"%b"\s*,(?:\s*"[^"]*"\s*,){3}\s*([-\d.eE+]+)' % name.encode()
    found = re.search(pattern, data)
    return float(found[1]) if found else None


def shapes(path: Path) -> list[NDArray[np.float64]]:
    """The vertices (V, 3) of every shape in a binary file; none if Blender cannot parse it."""
    try:
        parse = import_module("io_scene_fbx.parse_fbx").parse
        root, _ = parse(str(path))
    except (ImportError, OSError, AssertionError, ValueError, struct.error):
        return []
    objects = [each for each in root.elems if each is not None and each.id == b"Objects"]
    found = []
    for element in (each for group in objects for each in group.elems):
        if element.id == b"Geometry" and element.props[-1:] == [b"Mesh"]:
            for part in element.elems:
                if part.id == b"Vertices":
                    found.append(np.array(part.props[0], dtype=np.float64).reshape(-1, 3))
    return found
