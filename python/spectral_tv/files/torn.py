"""The error for a file that was cut short, and reading parts of files."""

import struct
from pathlib import Path
from typing import Any, BinaryIO


class Torn(Exception):
    """A file is not whole; the message says how that shows."""


def require(is_so: bool, otherwise: str) -> None:
    """Raise Torn with a message unless something is so."""
    if not is_so:
        raise Torn(otherwise)


def take(file: BinaryIO, layout: str) -> tuple[Any, ...]:
    """Read numbers in the layout of ``struct``; raises Torn at the end of the file."""
    size = struct.calcsize(layout)
    data = file.read(size)
    require(len(data) == size, f"it ends at byte {file.tell()}")
    return struct.unpack(layout, data)


def last(path: Path, count: int) -> bytes:
    """The last bytes of a file."""
    with path.open("rb") as file:
        file.seek(max(path.stat().st_size - count, 0))
        return file.read()


def number(word: bytes) -> float:
    """A number in a text; NaN for what is none."""
    try:
        return float(word)
    except ValueError:
        return float("nan")
