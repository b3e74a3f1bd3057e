"""The header of a PLY file, and what is in its parts."""

import re
import struct
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from spectral_tv.dataclass import dataclass

# NumPy's names of the types, under both of their names.
TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1",
    "short": "i2", "int16": "i2", "ushort": "u2", "uint16": "u2",
    "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip
CODES = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "f4": "f", "f8": "d"}
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

    @property
    def width(self) -> int:
        """The bytes of a number."""
        return int(self.type[1])


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
    elif element.count:
        end, data = file.tell(), np.memmap(file, np.uint8, "r").data
        try:
            rows = _equal_rows(data, end, element, order)
            if rows is not None:
                end += rows.nbytes
            else:
                for item, place, length in _walk(data, end, element, order):
                    end = place + length * item.width
        except (ValueError, struct.error):
            return False
        file.seek(end)
    return True


def _walk(
    data: memoryview, place: int, element: Element, order: str
) -> Iterator[tuple[Property, int, int]]:
    """Each property of each item: where its numbers are, and how many; raises struct.error."""
    codes = [CODES[item.count] if item.count else "" for item in element.properties]
    layout = [
        (item, struct.Struct(order + code), item.width)
        for item, code in zip(element.properties, codes, strict=True)
    ]
    for _ in range(element.count):
        for item, count, width in layout:
            (length,) = count.unpack_from(data, place) or (1,)  # what is no list is one number
            place += count.size
            yield item, place, length
            place += length * width


def _equal_rows(
    data: memoryview, place: int, element: Element, order: str
) -> NDArray[np.void] | None:
    """All items as rows, if their lists are as long as those of the first one; None if not."""
    kinds: list[tuple[str, str, int]] = []
    for item, _, length in _walk(data, place, replace(element, count=1), order):
        if item.count is not None:
            kinds.append((f"{item.name} count", order + item.count, 1))
        kinds.append((item.name, order + item.type, length))
    row = np.dtype([(name, kind, (length,)) for name, kind, length in kinds])
    if place + row.itemsize * element.count > len(data):
        return None
    rows = np.frombuffer(data, row, element.count, place)
    counts = [rows[name] for name, _, _ in kinds if name.endswith(" count")]
    return None if any((count != count[0]).any() for count in counts) else rows


@dataclass(frozen=True)
class Items:
    """Where the items of an element are in a file, and how they are stored."""

    path: Path
    header: Header
    element: Element
    begin: int
    end: int

    def _lines(self) -> list[bytes]:
        with self.path.open("rb") as file:
            file.seek(self.begin)
            return [file.readline() for _ in range(self.element.count)]

    @property
    def _row(self) -> np.dtype[Any]:
        row = self.element.row(self.header.order)
        assert row is not None
        return row

    def columns(self) -> dict[str, NDArray[np.generic]]:
        """The numbers of all items, by the names of properties; there must be no lists."""
        numbers = self._numbers()
        return {each.name: numbers[each.name].astype(each.type) for each in self.element.properties}

    def points(self) -> NDArray[np.float64]:
        """The coordinates, (V, 3), with all digits that the file has."""
        numbers = self._numbers()
        return np.column_stack([numbers[axis].astype(np.float64) for axis in AXES])

    def _numbers(self) -> Mapping[str, NDArray[Any]]:
        """The numbers as they are; those of text in double precision."""
        names = [each.name for each in self.element.properties]
        if self.header.order:
            rows = np.fromfile(self.path, self._row, self.element.count, offset=self.begin)
            return {name: rows[name] for name in names}
        values = np.loadtxt(self._lines(), usecols=range(len(names)), ndmin=2)
        return dict(zip(names, values.reshape(-1, len(names)).T, strict=True))

    def lists(self, name: str) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """The lengths of the lists of a name, and what is in all of them.

        Raises ValueError, IndexError or struct.error if the file does not hold them.
        """
        sizes: list[int] = []
        found: list[int] = []
        order = self.header.order
        if not order:
            for words in map(bytes.split, self._lines()):
                at = 0
                for item in self.element.properties:
                    length = int(words[at]) if item.count else 0
                    if item.name == name:
                        sizes.append(length)
                        found += [int(word) for word in words[at + 1 : at + 1 + length]]
                    at += 1 + length
        elif self.element.count:
            data = np.memmap(self.path, np.uint8, "r").data
            rows = _equal_rows(data, self.begin, self.element, order)
            if rows is not None:
                lists = rows[name].astype(np.int64)
                return np.full(len(lists), lists.shape[1]), lists.reshape(-1)
            for item, place, length in _walk(data, self.begin, self.element, order):
                if item.name == name:
                    sizes.append(length)
                    found += struct.unpack_from(f"{order}{length}{CODES[item.type]}", data, place)
        return np.array(sizes, dtype=np.int64), np.array(found, dtype=np.int64)

    def replace(self, target: Path, points: NDArray[np.float64]) -> None:
        """Write the file anew with other coordinates, (V, 3), in double precision."""
        data = self.path.read_bytes()
        rows, order = data[self.begin : self.end], self.header.order
        head = data[: self.header.start]
        for axis in AXES:
            single = rb"(property\s+)(?:float|float32)(\s+%b\s)" % axis.encode()
            head = re.sub(single, rb"\1double\2", head, count=1)
        own = self.element.properties
        if order:
            kinds = [
                (each.name, order + ("f8" if each.name in AXES else each.type)) for each in own
            ]
            new = np.frombuffer(rows, self._row).astype(np.dtype(kinds))
            for axis, values in zip(AXES, points.T, strict=True):
                new[axis] = values
            rows = new.tobytes()
        else:
            columns = [[each.name for each in own].index(axis) for axis in AXES]
            lines = zip(rows.splitlines(keepends=True), points.tolist(), strict=False)
            rows = b"".join(replaced(line, columns, point) for line, point in lines)
        with target.open("wb") as file:
            file.writelines((head, data[self.header.start : self.begin], rows, data[self.end :]))


def replaced(line: bytes, columns: Iterable[int], point: Iterable[float]) -> bytes:
    """A line of text with other numbers as some of its words."""
    words = line.split()
    for column, number in zip(columns, point, strict=True):
        words[column : column + 1] = [repr(number).encode()]
    return b" ".join(words) + b"\n"


def find(path: Path, header: Header, name: str) -> Items | None:
    """Where the items of an element are; None if there are none, or the file ends before."""
    with path.open("rb") as file:
        file.seek(header.start)
        for element in header.elements:
            begin = file.tell()
            is_there = _pass_over(file, element, header)
            if element.name == name:
                return Items(path, header, element, begin, file.tell())
            if not is_there:
                return None
    return None


def find_vertices(path: Path, header: Header) -> Items | None:
    """Where the vertices are; None if they have no three coordinates, or lists."""
    found = find(path, header, "vertex")
    if found is None or found.element.row("<") is None:
        return None
    return found if set(AXES) <= {item.name for item in found.element.properties} else None


def _pass_over(file: BinaryIO, element: Element, header: Header) -> bool:
    """Move past all items of an element; False if a binary file ends before."""
    if header.order:
        return skip(file, element, header.order)
    for _ in range(element.count):
        file.readline()
    return True
