"""The units and the axes of an FBX file, which Blender's importer does not tell."""

import re
import struct
from pathlib import Path

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
