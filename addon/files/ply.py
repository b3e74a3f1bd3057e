"""The header of a PLY file, the coordinates of its vertices, and how long its parts are."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

# NumPy's names of the types, under both of their names.
TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1",
    "short": "i2", "int16": "i2", "ushort": "u2", "uint16": "u2",
    "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
LONGEST_LINE = 4096
AXES = ("x", "y", "z")


class NoHeader(ValueError):
    """A file does not begin with the header of a PLY file."""


@dataclass(frozen=True)
class Property:
    """A number of each item, or a list of numbers if ``count`` is the type of its length."""

    name: str
    type: str
    count: str | None = None


@dataclass(frozen=True)
class Element:
    """Items of one kind, such as vertices, and what is stored of each."""

    name: str
    count: int
    properties: tuple[Property, ...]

    def row(self, order: str) -> np.dtype[Any] | None:
        """The layout of an item in a binary file; None if items have lists."""
        if any(item.count is not None for item in self.properties):
            return None
        return np.dtype([(item.name, order + item.type) for item in self.properties])

    def columns(self, names: Sequence[str]) -> list[int]:
        """Which numbers of an item these are; raises ValueError if one is not there."""
        own = [item.name for item in self.properties]
        return [own.index(name) for name in names]


@dataclass(frozen=True)
class Header:
    """What a PLY file says of itself; its data begin at byte ``start``."""

    format: str
    elements: tuple[Element, ...]
    comments: tuple[bytes, ...]
    start: int

    @property
    def order(self) -> str:
        """The order of bytes as NumPy writes it; empty where numbers are text."""
        return ORDERS[self.format]

    def element(self, name: str) -> Element | None:
        """The element of that name."""
        return next((element for element in self.elements if element.name == name), None)

    @property
    def is_double(self) -> bool:
        """Whether the coordinates of vertices have double precision."""
        vertex = self.element("vertex")
        kinds = {item.name: item.type for item in vertex.properties} if vertex else {}
        return any(kinds.get(axis) == "f8" for axis in AXES)


def read_header(path: Path) -> Header:
    """Read the header of a PLY file; raises NoHeader."""
    try:
        with path.open("rb") as file:
            return _header(file)
    except (KeyError, IndexError, ValueError) as error:
        raise NoHeader("it has no header of a PLY file") from error


def _header(file: BinaryIO) -> Header:
    if file.readline(LONGEST_LINE).strip() != b"ply":
        raise NoHeader
    form = ""
    elements: list[tuple[str, int, list[Property]]] = []
    comments: list[bytes] = []
    while line := file.readline(LONGEST_LINE):
        match line.decode("ascii", "replace").split():
            case ["format", name, _]:
                form = name
            case ["element", name, count]:
                elements.append((name, int(count), []))
            case ["property", "list", count, kind, name]:
                elements[-1][2].append(Property(name, TYPES[kind], TYPES[count]))
            case ["property", kind, name]:
                elements[-1][2].append(Property(name, TYPES[kind]))
            case ["comment" | "obj_info", *_]:
                comments.append(line.strip())
            case ["end_header"]:
                found = (Element(name, count, tuple(items)) for name, count, items in elements)
                ORDERS[form]
                return Header(form, tuple(found), tuple(comments), file.tell())
            case []:
                pass
            case _:
                raise NoHeader
    raise NoHeader


def skip(file: BinaryIO, element: Element, order: str) -> bool:
    """Move past all items of an element in a binary file; False if the file ends before."""
    row = element.row(order)
    if row is not None:
        file.seek(element.count * row.itemsize, 1)
        return True
    if element.count == 0:
        return True
    place = file.tell()
    data = np.memmap(file, np.uint8, "r")
    end = _end_of_equals(data, place, element, order)
    if end is None:
        end = _end(data, place, element, order)
    if end is None:
        return False
    file.seek(end)
    return True


def _end_of_equals(data: NDArray[np.uint8], place: int, element: Element, order: str) -> int | None:
    """Where items end whose lists are all as long as those of the first one; None if not."""
    first = _end(data, place, element, order, 1)
    if first is None or place + (first - place) * element.count > len(data):
        return None
    size = first - place
    rows = data[place : place + size * element.count].reshape(element.count, size)
    at = 0
    for item in element.properties:
        width = np.dtype(item.type).itemsize
        if item.count is None:
            at += width
            continue
        count = np.dtype(order + item.count)
        length = rows[:, at : at + count.itemsize]
        if (length != length[0]).any():
            return None
        at += count.itemsize + int(length[0].copy().view(count)[0]) * width
    return place + size * element.count


def _end(
    data: NDArray[np.uint8], place: int, element: Element, order: str, number: int | None = None
) -> int | None:
    """Where so many items end, or all, counted one by one; None if the data end before."""
    for _ in range(element.count if number is None else number):
        for item in element.properties:
            width = np.dtype(item.type).itemsize
            if item.count is None:
                place += width
                continue
            count = np.dtype(order + item.count)
            if place + count.itemsize > len(data):
                return None
            length = int(data[place : place + count.itemsize].view(count)[0])
            place += count.itemsize + length * width
    return place


@dataclass(frozen=True)
class Vertices:
    """Where the vertices of a file are in it, and how they are stored."""

    header: Header
    element: Element
    begin: int
    end: int

    def read(self, path: Path) -> NDArray[np.float64]:
        """The coordinates, (V, 3)."""
        columns = self.element.columns(AXES)
        if not self.header.order:
            with path.open("rb") as file:
                file.seek(self.begin)
                lines = [file.readline() for _ in range(self.element.count)]
            return np.loadtxt(lines, usecols=columns, ndmin=2).reshape(-1, 3)
        rows = np.fromfile(path, self._row, self.element.count, offset=self.begin)
        return np.column_stack([rows[axis].astype(np.float64) for axis in AXES])

    @property
    def _row(self) -> np.dtype[Any]:
        row = self.element.row(self.header.order)
        assert row is not None
        return row

    def replace(self, path: Path, target: Path, points: NDArray[np.float64]) -> None:
        """Write the file anew with other coordinates, (V, 3), in double precision."""
        data = path.read_bytes()
        rows = data[self.begin : self.end]
        head = data[: self.header.start]
        for axis in AXES:
            single = rb"(property\s+)(?:float|float32)(\s+%b\s)" % axis.encode()
            head = re.sub(single, rb"\1double\2", head, count=1)
        if self.header.order:
            old = np.frombuffer(rows, self._row)
            order = self.header.order
            kinds = [
                (item.name, order + ("f8" if item.name in AXES else item.type))
                for item in self.element.properties
            ]
            new = old.astype(np.dtype(kinds))
            for axis, values in zip(AXES, points.T, strict=True):
                new[axis] = values
            rows = new.tobytes()
        else:
            columns = self.element.columns(AXES)
            rows = b"".join(
                replaced(line, columns, point)
                for line, point in zip(
                    rows.splitlines(keepends=True), points.tolist(), strict=False
                )
            )
        with target.open("wb") as file:
            file.writelines((head, data[self.header.start : self.begin], rows, data[self.end :]))


def replaced(line: bytes, columns: Iterable[int], point: Iterable[float]) -> bytes:
    """A line of text with other numbers as some of its words."""
    words = line.split()
    for column, number in zip(columns, point, strict=True):
        words[column : column + 1] = [repr(number).encode()]
    return b" ".join(words) + b"\n"


def find_vertices(path: Path, header: Header) -> Vertices | None:
    """Where the vertices are; None if they have no three coordinates, or lists."""
    with path.open("rb") as file:
        file.seek(header.start)
        for element in header.elements:
            begin = file.tell()
            if element.name == "vertex":
                if element.row("<") is None or not set(AXES) <= {
                    p.name for p in element.properties
                }:
                    return None
                pass_over(file, element, header)
                return Vertices(header, element, begin, file.tell())
            if not pass_over(file, element, header):
                return None
    return None


def pass_over(file: BinaryIO, element: Element, header: Header) -> bool:
    """Move past all items of an element; False if a binary file ends before."""
    if header.order:
        return skip(file, element, header.order)
    for _ in range(element.count):
        file.readline()
    return True
