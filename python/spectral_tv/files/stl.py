"""The kind of an STL file, and the corners of its triangles."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from spectral_tv.files.faces import Faces
from spectral_tv.files.torn import number

HEAD = 84
TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def is_text(path: Path) -> bool:
    """Whether an STL file is one of text; there are binary ones that begin like it."""
    with path.open("rb") as file:
        head = file.read(1024)
    return head.lstrip().startswith(b"solid") and (b"facet" in head or b"endsolid" in head)


def triangles(path: Path) -> NDArray[np.void]:
    """The triangles of a binary file as it stores them, as many as are there."""
    with path.open("rb") as file:
        told = int.from_bytes(file.read(HEAD)[-4:], "little")
    # The file may be cut short, and the array would be as large as it says.
    there = max(0, path.stat().st_size - HEAD) // TRIANGLE.itemsize
    return np.fromfile(path, TRIANGLE, min(told, there), offset=HEAD)


def points(path: Path) -> NDArray[np.float64]:
    """The places of all corners, three for each triangle, (3 T, 3)."""
    if not is_text(path):
        return triangles(path)["corners"].reshape(-1, 3).astype(np.float64)
    found = []
    with path.open("rb") as file:
        for line in file:
            words = line.split()
            if words[:1] == [b"vertex"]:
                found.append([number(word) for word in [*words[1:4], b"", b"", b""][:3]])
    return np.array(found, dtype=np.float64).reshape(-1, 3)


def faces(corners: NDArray[np.float64]) -> Faces:
    """Triangles of corners at these places, (3 T, 3), joined where floats are equal."""
    with np.errstate(over="ignore"):
        single = corners.astype(np.float32) + np.float32(0)
    _, places = np.unique(single, axis=0, return_inverse=True)
    count = len(corners) // 3
    return Faces(np.full(count, 3), places.reshape(-1)[: 3 * count].astype(np.int64), len(corners))
