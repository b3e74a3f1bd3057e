"""The whole content of a PLY file that Blender wrote, and the lists in PLY files of others."""

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .faces import Faces
from .ply import ORDERS, TYPES, Element, Header, pass_over, read_header

CODES = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "f4": "f", "f8": "d"}
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
    vertex = header.element("vertex")
    assert vertex is not None
    columns = _columns(path, header, vertex)
    edge = header.element("edge")
    is_plain = edge is not None and edge.row("<") is not None
    ends = _columns(path, header, edge) if edge is not None and is_plain else {}
    edges = [ends[name].astype(np.int64) for name in ENDS if set(ENDS) <= set(ends)]
    faces = read_faces(path, header)
    none = np.zeros(0, dtype=np.int64)
    return Table(
        header,
        columns,
        faces if faces is not None else Faces(none, none, vertex.count),
        np.column_stack(edges) if edges else np.zeros((0, 2), dtype=np.int64),
    )


def read_faces(path: Path, header: Header) -> Faces | None:
    """The faces of a PLY file; None if it has none, or they cannot be read."""
    vertex, face = header.element("vertex"), header.element("face")
    names = [item.name for item in face.properties if item.count] if face is not None else []
    name = next((name for name in CORNERS if name in names), None)
    if face is None or vertex is None or name is None:
        return None
    try:
        sizes, corners = _lists(path, header, face, name)
    except (ValueError, IndexError, struct.error):
        return None
    # What was written as −1 is the largest number where the type has no sign.
    return Faces(sizes, corners, vertex.count)


def _begin(path: Path, header: Header, wanted: Element) -> int:
    with path.open("rb") as file:
        file.seek(header.start)
        for element in header.elements:
            if element is wanted or not pass_over(file, element, header):
                break
        return file.tell()


def _lines(path: Path, header: Header, element: Element) -> list[list[bytes]]:
    with path.open("rb") as file:
        file.seek(_begin(path, header, element))
        return [file.readline().split() for _ in range(element.count)]


def _columns(path: Path, header: Header, element: Element) -> dict[str, NDArray[np.generic]]:
    row = element.row(header.order or "<")
    assert row is not None
    if header.order:
        rows = np.fromfile(path, row, element.count, offset=_begin(path, header, element))
        return {name: rows[name] for name in row.names or ()}
    words = np.array(_lines(path, header, element)).reshape(element.count, -1)
    return {
        item.name: words[:, place].astype(np.float64).astype(item.type)
        for place, item in enumerate(element.properties)
    }


def _lists(
    path: Path, header: Header, element: Element, name: str
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The lengths of the lists of a name, and what is in all of them."""
    sizes: list[int] = []
    found: list[int] = []
    if not header.order:
        for words in _lines(path, header, element):
            at = 0
            for item in element.properties:
                length = int(words[at]) if item.count else 0
                if item.name == name:
                    sizes.append(length)
                    found += [int(word) for word in words[at + 1 : at + 1 + length]]
                at += 1 + length
        return np.array(sizes, dtype=np.int64), np.array(found, dtype=np.int64)
    begin = _begin(path, header, element)
    data = memoryview(path.read_bytes())[begin:]
    if (equal := _equal_lists(data, element, header.order, name)) is not None:
        return equal
    order, place = header.order, 0
    for _ in range(element.count):
        for item in element.properties:
            if item.count is None:
                place += np.dtype(item.type).itemsize
                continue
            (length,) = struct.unpack_from(order + CODES[item.count], data, place)
            place += np.dtype(item.count).itemsize
            if item.name == name:
                sizes.append(length)
                found += struct.unpack_from(f"{order}{length}{CODES[item.type]}", data, place)
            place += length * np.dtype(item.type).itemsize
    return np.array(sizes, dtype=np.int64), np.array(found, dtype=np.int64)


def _equal_lists(
    data: memoryview, element: Element, order: str, name: str
) -> tuple[NDArray[np.int64], NDArray[np.int64]] | None:
    """The same where the lists of all items are as long as those of the first; else None."""
    kinds: list[tuple[str, str, int]] = []
    place = 0
    for item in element.properties if element.count else ():
        length = 1
        if item.count is not None:
            (length,) = struct.unpack_from(order + CODES[item.count], data, place)
            kinds.append((f"{item.name} count", order + item.count, 1))
            place += np.dtype(item.count).itemsize
        kinds.append((item.name, order + item.type, length))
        place += length * np.dtype(item.type).itemsize
    row = np.dtype([(key, kind, (length,)) for key, kind, length in kinds])
    if not kinds or row.itemsize * element.count > len(data):
        return None
    rows = np.frombuffer(data, row, element.count)
    counts = [rows[key] for key, _, _ in kinds if key.endswith(" count")]
    if any((count != count[0]).any() for count in counts):
        return None
    lists = rows[name].astype(np.int64)
    return np.full(element.count, lists.shape[1]), lists.reshape(-1)
