"""The header of a PLY file, and how long what follows it is."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

# NumPy's names of the types, under both of their names.
TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1",
    "short": "i2", "int16": "i2", "ushort": "u2", "uint16": "u2",
    "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
LONGEST_LINE = 4096


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


@dataclass(frozen=True)
class Header:
    """What a PLY file says of itself; its data begin at byte ``start``."""

    format: str
    elements: tuple[Element, ...]
    start: int

    @property
    def order(self) -> str:
        """The order of bytes as NumPy writes it; empty where numbers are text."""
        return ORDERS[self.format]

    def element(self, name: str) -> Element | None:
        """The element of that name."""
        return next((element for element in self.elements if element.name == name), None)


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
            case ["end_header"]:
                found = (Element(name, count, tuple(items)) for name, count, items in elements)
                ORDERS[form]
                return Header(form, tuple(found), file.tell())
            case ["comment" | "obj_info", *_] | []:
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
    size = file.seek(0, 1)
    data = np.memmap(file, np.uint8, "r") if element.count else np.empty(0, np.uint8)
    for _ in range(element.count):
        for item in element.properties:
            width = np.dtype(item.type).itemsize
            if item.count is None:
                size += width
                continue
            count = np.dtype(order + item.count)
            if size + count.itemsize > len(data):
                return False
            length = int(data[size : size + count.itemsize].view(count)[0])
            size += count.itemsize + length * width
    file.seek(size)
    return True
