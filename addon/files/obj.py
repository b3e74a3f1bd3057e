"""What is in an OBJ file, as far as Blender reads it, and writing it anew with other vertices."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from .faces import Faces

NAN = float("nan")


@dataclass
class Section:
    """What comes after a line ``o``, or before the first: how many vertices came before it, and
    how many faces and lines it has.
    """

    name: str
    first: int
    drawn: int = 0


@dataclass
class Obj:
    """The vertices of a file, (V, 3), its faces, its objects, and the names of its groups.

    ``loose`` are the vertices that nothing refers to, and ``ends`` tells whether its last line
    has an end.
    """

    points: NDArray[np.float64]
    faces: Faces
    sections: list[Section]
    groups: list[str]
    loose: NDArray[np.int64]
    ends: bool

    def loose_of_sections(self) -> dict[int, NDArray[np.int64]]:
        """The loose vertices, by the section with faces whose they are most likely."""
        drawn = [place for place, section in enumerate(self.sections) if section.drawn]
        if not drawn:
            return {}
        firsts = [section.first for section in self.sections[1:]]
        own = np.searchsorted(firsts, self.loose, side="right")
        # In a section without faces they belong to the next one with faces.
        places = np.searchsorted(drawn, own)
        target = np.where(places < len(drawn), np.append(drawn, 0)[places], own)
        return {int(place): self.loose[target == place] for place in np.unique(target)}


@dataclass
class _Found:
    points: list[list[float]] = field(default_factory=list)
    sizes: list[int] = field(default_factory=list)
    corners: list[int] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)


def read(path: Path) -> Obj:
    """Read the parts of a file that tell what its shapes are made of."""
    found = _Found()
    points, sizes, corners = found.points, found.sizes, found.corners
    sections = [Section("", 0)]
    groups: dict[str, None] = {}
    line = b"\n"
    with path.open("rb") as file:
        for line in whole_lines(file):
            words = line.split()
            match words[:1]:
                case [b"v"]:
                    points.append([_number(word) for word in [*words[1:4], b"", b"", b""][:3]])
                case [b"f"]:
                    count = len(points)
                    own = [_index(word, count) for word in words[1:]]
                    sizes.append(len(own))
                    corners.extend(own)
                    sections[-1].drawn += 1
                case [b"l"]:
                    found.lines += [_index(word, len(points)) for word in words[1:]]
                    sections[-1].drawn += 1
                case [b"o"]:
                    name = line.split(None, 1)[1:] or [b""]
                    sections.append(Section(_text(name[0]), len(points)))
                case [b"g"] if len(words) > 1:
                    groups[_text(line.split(None, 1)[1])] = None
    used = np.zeros(len(points), dtype=bool)
    indices = np.array(corners + found.lines, dtype=np.int64)
    used[indices[(indices >= 0) & (indices < len(points))]] = True
    return Obj(
        np.array(points, dtype=np.float64).reshape(-1, 3),
        Faces(np.array(sizes, dtype=np.int64), np.array(corners, dtype=np.int64), len(points)),
        sections,
        list(groups),
        np.flatnonzero(~used),
        line.endswith((b"\n", b"\r")),
    )


def whole_lines(file: BinaryIO) -> Iterator[bytes]:
    """The lines of a file, those joined that go on after a backslash."""
    held = b""
    for line in file:
        if line.rstrip(b"\r\n").endswith(b"\\"):
            held += line.rstrip(b"\r\n")[:-1] + b" "
            continue
        yield held + line
        held = b""
    if held:
        yield held


def refer_to(vertices: NDArray[np.int64]) -> bytes:
    """Lines by which Blender takes vertices for those of the object, though they are in no face."""
    return b"".join(b"l %d %d\n" % (vertex + 1, vertex + 1) for vertex in vertices.tolist())


def _number(word: bytes) -> float:
    try:
        return float(word)
    except ValueError:
        return NAN


def _index(word: bytes, count: int) -> int:
    """The vertex, from 0, of a corner after so many vertices; −1 if it refers to none of them."""
    try:
        number = int(word.partition(b"/")[0])
    except ValueError:
        return -1
    place = number - 1 if number > 0 else count + number
    return place if 0 <= place < count and number else -1


def _text(name: bytes) -> str:
    return name.strip().decode(errors="replace")
