"""What is in an OBJ file, as far as Blender reads it, and writing it anew with other vertices."""

from collections.abc import Iterator
from dataclasses import field
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from spectral_tv.dataclass import dataclass
from spectral_tv.files.faces import Faces
from spectral_tv.files.torn import number

# So many lines are parsed at once.
SOME = 1 << 16


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
    """Vertices, and the corners of faces or lines, of which some are still text."""

    points: list[NDArray[np.float64]] = field(default_factory=list)
    rows: list[list[bytes]] = field(default_factory=list)
    corners: list[NDArray[np.int64]] = field(default_factory=list)
    words: list[bytes] = field(default_factory=list)
    sizes: list[int] = field(default_factory=list)
    counts: list[int] = field(default_factory=list)
    parsed: int = 0

    def parse(self) -> None:
        """Parse what is still text."""
        self.points.append(_numbers(self.rows))
        sizes = self.sizes[self.parsed :]
        self.corners.append(_indices(self.words, np.repeat(self.counts, sizes)))
        self.parsed = len(self.sizes)
        self.rows, self.words, self.counts = [], [], []


def read(path: Path) -> Obj:
    """Read the parts of a file that tell what its shapes are made of."""
    faces, others = _Found(), _Found()
    count = 0
    sections = [Section("", 0)]
    groups: dict[str, None] = {}
    line = b"\n"
    with path.open("rb") as file:
        for line in whole_lines(file):
            words = line.split()
            word = words[0] if words else b""
            if word == b"v":
                count += 1
                faces.rows.append(words[1:4])
                if len(faces.rows) == SOME:
                    faces.parse()
            elif word in (b"f", b"l"):
                found = faces if word == b"f" else others
                found.sizes.append(len(words) - 1)
                found.words += words[1:]
                found.counts.append(count)
                sections[-1].drawn += 1
                if len(found.counts) == SOME:
                    found.parse()
            elif word == b"o":
                name = line.split(None, 1)[1:] or [b""]
                sections.append(Section(_text(name[0]), count))
            elif word == b"g" and len(words) > 1:
                groups[_text(line.split(None, 1)[1])] = None
    faces.parse()
    others.parse()
    corners = np.concatenate(faces.corners)
    used = np.zeros(count, dtype=bool)
    for indices in (corners, *others.corners):
        used[indices[indices >= 0]] = True
    return Obj(
        np.concatenate(faces.points),
        Faces(np.array(faces.sizes, dtype=np.int64), corners, count),
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


def _numbers(rows: list[list[bytes]]) -> NDArray[np.float64]:
    """Coordinates (V, 3); NaN for what is no number, or missing."""
    try:
        return np.array(rows, dtype="S").reshape(-1, 3).astype(np.float64)
    except ValueError:
        full = ([*row, b"", b"", b""][:3] for row in rows)
        return np.array([[number(word) for word in row] for row in full])


def _indices(words: list[bytes], counts: NDArray[np.int64]) -> NDArray[np.int64]:
    """The vertices, from 0, of corners, each after so many; −1 where it is none of these."""
    if not words:
        return np.zeros(0, dtype=np.int64)
    firsts = [word.partition(b"/")[0] for word in words]
    try:
        numbers = np.array(firsts, dtype="S").astype(np.int64)
    except (ValueError, OverflowError):
        numbers = np.array([_whole(word) for word in firsts], dtype=np.int64)
    places = np.where(numbers > 0, numbers - 1, counts + numbers)
    is_there = (places >= 0) & (places < counts) & (numbers != 0)
    return np.where(is_there, places, -1)


def _whole(word: bytes) -> int:
    """A number as small as a vertex may have; 0 for all else."""
    try:
        found = int(word)
    except ValueError:
        return 0
    return found if abs(found) < 1 << 40 else 0


def _text(name: bytes) -> str:
    return name.strip().decode(errors="replace")
