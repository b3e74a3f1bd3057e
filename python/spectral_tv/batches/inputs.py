"""The inputs of a batch: files, those in folders, and those that patterns and lists name."""

import glob
import os
import sys
from collections.abc import Callable, Collection, Iterator
from dataclasses import field
from pathlib import Path

from spectral_tv.command_line.places import is_folder
from spectral_tv.dataclass import dataclass
from spectral_tv.refusal import Refusal


@dataclass
class Inputs:
    """Files, and in which folder beneath that of the results the result of each goes."""

    files: list[Path] = field(default_factory=list)
    beneath: dict[Path, Path] = field(default_factory=dict)

    def add(self, path: Path, beneath: Path, *, is_named: bool) -> None:
        """Add a file; only one that is named may be there twice, which is told as a clash."""
        if is_named or path not in self.beneath:
            self.files.append(path)
        self.beneath.setdefault(path, beneath)


def share(files: list[Path], part: tuple[int, int] | None) -> list[Path]:
    """The i-th of n shares of the files, as ``(i, n)`` with i from 1; all if None."""
    if part is None:
        return files
    number, count = part
    return files[number - 1 :: count]


def inputs_of(
    named: list[Path],
    list_: Path | None,
    suffixes: Collection[str],
    output: Path | None,
    is_one: Callable[[Path], bool] = lambda _folder: False,
) -> Inputs:
    """What the names and those in a list stand for.

    A folder stands for all files in it, and beneath, that can be read. What is in the folder
    ``output`` is left out, and so is what begins with a dot. A folder that ``is_one`` input stands
    for itself. A name that is no file may be a pattern. Raises Refusal if one stands for nothing.
    """
    found = Inputs()
    for name in [*named, *(_listed(list_) if list_ is not None else [])]:
        for place in _matching(name):
            if not is_folder(place) or is_one(place):
                found.add(place, Path(), is_named=place == name)
                continue
            within = list(_within(place, suffixes, output))
            if not within:
                raise Refusal(f"there is no file in the folder {place} that can be read")
            for path in within:
                found.add(path, path.parent.relative_to(place), is_named=False)
    return found


def _listed(list_: Path) -> list[Path]:
    """The names in a list, one in a line; ``-`` is standard input."""
    try:
        text = sys.stdin.read() if str(list_) == "-" else list_.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise Refusal(f"--files-from {list_}: {error}") from error
    found = [Path(line).expanduser() for line in text.splitlines() if line.strip()]
    if not found:
        raise Refusal(f"--files-from {list_}: there is no name in it")
    return found


def _matching(name: Path) -> list[Path]:
    """What a name stands for, as a pattern if there is nothing of that name."""
    try:
        if name.exists() or not glob.has_magic(str(name)):
            return [name]
        matching = sorted(glob.glob(str(name), recursive=True))
    except (OSError, ValueError):  # a name that is too long
        return [name]
    if not matching:
        raise Refusal(f"no file has a name like {name}")
    return [Path(each) for each in matching]


def _within(folder: Path, suffixes: Collection[str], output: Path | None) -> Iterator[Path]:
    """The files beneath a folder that can be read, in the order of their names."""
    left_out = None if output is None else output.resolve()
    for root, folders, names in os.walk(folder):
        place = Path(root)
        folders[:] = sorted(
            name
            for name in folders
            if not name.startswith(".") and (place / name).resolve() != left_out
        )
        for name in sorted(names):
            path = place / name
            if not name.startswith(".") and path.suffix.lower() in suffixes:
                yield path
