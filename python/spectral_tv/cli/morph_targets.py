"""Morph targets in binary glTF, which trimesh writes without them.

A GLB file is a header, a chunk of JSON and a chunk of bytes (Khronos glTF 2.0, section 4). A morph
target of a mesh is an accessor of displacements (section 3.7.2.2).
"""

import json
import struct
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

MAGIC, VERSION = b"glTF", 2
JSON, BINARY = b"JSON", b"BIN\0"
FLOAT = 5126
ALIGNED = 4


def with_morph_targets(
    content: bytes, bands: Mapping[str, NDArray[np.float64]], values: Sequence[float]
) -> bytes:
    """Add displacements (V, 3) by name, and their values, to a GLB file with one mesh of V
    vertices."""
    tree, binary = _parts(content)
    (mesh,) = tree["meshes"]
    (primitive,) = mesh["primitives"]
    primitive["targets"] = []
    for band in bands.values():
        place = _add(tree, binary, np.asarray(band, dtype="<f4"))
        primitive["targets"].append({"POSITION": place})
    mesh["weights"] = [float(value) for value in values]
    mesh.setdefault("extras", {})["targetNames"] = list(bands)
    tree["buffers"][0]["byteLength"] = len(binary)
    return _joined(tree, bytes(binary))


def _parts(content: bytes) -> tuple[Any, bytearray]:
    magic, version, _ = struct.unpack_from("<4sII", content)
    if (magic, version) != (MAGIC, VERSION):
        raise ValueError("this is no binary glTF 2.0")
    chunks, place = {}, 12
    while place < len(content):
        length, kind = struct.unpack_from("<I4s", content, place)
        chunks[kind] = content[place + 8 : place + 8 + length]
        place += 8 + length
    return json.loads(chunks[JSON]), bytearray(chunks[BINARY])


def _add(tree: Any, binary: bytearray, values: NDArray[np.float32]) -> int:
    """Add an accessor of vectors and return its number."""
    binary += b"\0" * (-len(binary) % ALIGNED)
    view = {"buffer": 0, "byteOffset": len(binary), "byteLength": values.nbytes}
    binary += values.tobytes()
    tree["bufferViews"].append(view)
    tree["accessors"].append(
        {
            "bufferView": len(tree["bufferViews"]) - 1,
            "componentType": FLOAT,
            "count": len(values),
            "type": "VEC3",
            "min": [float(each) for each in values.min(axis=0)],
            "max": [float(each) for each in values.max(axis=0)],
        }
    )
    return len(tree["accessors"]) - 1


def _joined(tree: Any, binary: bytes) -> bytes:
    text = json.dumps(tree, separators=(",", ":")).encode()
    text += b" " * (-len(text) % ALIGNED)
    binary += b"\0" * (-len(binary) % ALIGNED)
    chunks = b"".join(
        struct.pack("<I4s", len(chunk), kind) + chunk
        for kind, chunk in ((JSON, text), (BINARY, binary))
    )
    return struct.pack("<4sII", MAGIC, VERSION, 12 + len(chunks)) + chunks
