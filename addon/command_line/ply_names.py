"""Names in a PLY file without spaces.

Blender writes the names of vertex groups and attributes as they are. A name with a space makes a
header that nobody can read.
"""

import os
import shutil
from pathlib import Path

from spectral_tv.notes import listed, note

END = b"end_header\n"
# What stands before the name of a property, and before that of a list.
WORDS, OF_LIST = 2, 4


def mend(path: Path) -> None:
    """Write names that have spaces with lines in their place, and note that."""
    with path.open("rb") as file:
        lines = []
        while (line := file.readline()) and line != END:
            lines.append(line)
        mended, changed = _mended(lines)
        if not line or not changed:
            return
        target = path.with_stem(f"{path.stem}_named")
        with target.open("wb") as other:
            other.writelines((*mended, END))
            shutil.copyfileobj(file, other)
    os.replace(target, path)
    note(f"a .ply has no names with spaces, so these have _ there: {listed(changed)}")


def _mended(lines: list[bytes]) -> tuple[list[bytes], list[str]]:
    """The lines of a header, and the names that were changed in them."""
    mended, changed = [], []
    taken: set[bytes] = set()
    for line in lines:
        kept, words = line, line.rstrip(b"\n").split(b" ")
        if words[0] == b"element":
            taken = set()
        if words[0] == b"property":
            before = OF_LIST if words[1:2] == [b"list"] else WORDS
            name = b"_".join(words[before:])
            while name in taken:
                name += b"_"
            taken.add(name)
            if len(words) > before + 1:
                changed.append(b" ".join(words[before:]).decode(errors="replace"))
            kept = b" ".join([*words[:before], name]) + b"\n"
        mended.append(kept)
    return mended, changed
