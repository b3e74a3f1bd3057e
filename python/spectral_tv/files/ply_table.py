"""The whole content of a PLY file that Blender wrote, and the faces of those of others."""

import struct
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from spectral_tv.dataclass import dataclass
from spectral_tv.files.faces import Faces
from spectral_tv.files.ply import ORDERS, TYPES, Header, find, read_header

NAMES = {kind: name for name, kind in reversed(TYPES.items())}
ENDS = ("vertex1", "vertex2")
CORNERS = ("vertex_indices", "vertex_index")


@dataclass
class Table:
    """A file of vertices, faces and edges: a column of numbers for each property of vertices."""

    header: Header
    columns: dict[str, NDArray[np.generic]]
    faces: Faces
    edges: NDArray[np.int64]

    def write(self, path: Path, form: str | None, comments: Sequence[bytes]) -> None:
        """Write the file, in another format if one is named, with comments beside its own."""
        form = form or self.header.format
        order = ORDERS[form]
        edge = self.header.element("edge")
        count = len(next(iter(self.columns.values())))
        head = [b"ply", b"format %b 1.0" % form.encode()]
        head += [*self.header.comments, *comments, b"element vertex %d" % count]
        for name, values in self.columns.items():
            kind = NAMES[values.dtype.str[1:]]
            head.append(f"property {kind} {name}".encode())
        head.append(b"element face %d" % len(self.faces.sizes))
        counts = NAMES[self._counts].encode()
        head.append(b"property list %b uint vertex_indices" % counts)
        if edge is not None:
            head.append(b"element edge %d" % len(self.edges))
            head += [b"property int vertex1", b"property int vertex2"]
        with path.open("wb") as file:
            file.writelines(line + b"\n" for line in [*head, b"end_header"])
            file.write(self._binary(order) if order else self._text())

    @property
    def _counts(self) -> str:
        """The type of how many corners faces have."""
        return "u1" if self.faces.sizes.max(initial=0) < 256 else "u4"

    def _binary(self, order: str) -> bytes:
        kinds = [(name, order + values.dtype.str[1:]) for name, values in self.columns.items()]
        rows = np.empty(len(next(iter(self.columns.values()))), np.dtype(kinds))
        for name, values in self.columns.items():
            rows[name] = values
        sizes, corners = self.faces.sizes, self.faces.corners
        counts = np.dtype(order + self._counts)
        lengths = counts.itemsize + 4 * sizes
        starts = np.cumsum(lengths) - lengths
        data = np.empty(int(lengths.sum()), dtype=np.uint8)
        is_count = np.zeros(len(data), dtype=bool)
        is_count[starts[:, np.newaxis] + np.arange(counts.itemsize)] = True
        data[is_count] = sizes.astype(counts).view(np.uint8)
        data[~is_count] = corners.astype(order + "u4").view(np.uint8)
        return rows.tobytes() + data.tobytes() + self.edges.astype(order + "i4").tobytes()

    def _text(self) -> bytes:
        texts = [values.astype("S32").tolist() for values in self.columns.values()]
        lines = [b" ".join(row) for row in zip(*texts, strict=True)]
        for corners in np.split(self.faces.corners, np.cumsum(self.faces.sizes)[:-1]):
            lines.append(b" ".join(b"%d" % number for number in (len(corners), *corners)))
        if len(self.faces.sizes) == 0:
            lines.pop()
        lines += [b"%d %d" % tuple(edge) for edge in self.edges.tolist()]
        return b"".join(line + b"\n" for line in lines)


def read(path: Path) -> Table:
    """Read a file that Blender wrote."""
    header = read_header(path)
    vertices, edges = (find(path, header, name) for name in ("vertex", "edge"))
    assert vertices is not None
    is_plain = edges is not None and edges.element.row("<") is not None
    ends = edges.columns() if edges is not None and is_plain else {}
    none = np.zeros(0, dtype=np.int64)
    pairs = [ends.get(name, none).astype(np.int64) for name in ENDS]
    faces = read_faces(path, header) or Faces(none, none, vertices.element.count)
    return Table(header, vertices.columns(), faces, np.column_stack(pairs))


def read_faces(path: Path, header: Header) -> Faces | None:
    """The faces of a PLY file; None if it has none, or they cannot be read."""
    vertex, faces = header.element("vertex"), find(path, header, "face")
    names = [item.name for item in faces.element.properties if item.count] if faces else []
    name = next((name for name in CORNERS if name in names), None)
    if faces is None or vertex is None or name is None:
        return None
    try:
        # What was written as −1 is the largest number where the type has no sign.
        return Faces(*faces.lists(name), vertex.count)
    except (ValueError, IndexError, struct.error):
        return None
