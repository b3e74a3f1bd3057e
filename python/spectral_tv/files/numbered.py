"""Folders of numbered files: one for each frame of something that moves."""

import re
from collections.abc import Container, Mapping
from pathlib import Path

from spectral_tv.dataclass import dataclass
from spectral_tv.notes import listed, note
from spectral_tv.refusal import Refusal

# What stands before the number, the number, and the suffix.
NAME = re.compile(r"(?P<stem>.*?)(?P<number>\d+)(?P<suffix>\.[^.]+)", re.DOTALL)
# What belongs to files of meshes.
COMPANIONS = {".bin", ".bmp", ".jpeg", ".jpg", ".mtl", ".png", ".tga", ".tif", ".tiff"}
# Digits of the numbers that are written, as Blender has them.
DIGITS = 4


@dataclass(frozen=True)
class Numbered:
    """The files of a folder by their numbers, in order; the last file without its number."""

    files: Mapping[int, Path]
    unnumbered: Path

    @classmethod
    def of(cls, folder: Path, suffixes: Container[str]) -> "Numbered":
        """Look into a folder for files of such suffixes, in small letters.

        Raises Refusal if these are not of one sequence.
        """
        found: dict[tuple[str, str], dict[int, Path]] = {}
        others = []
        for path in sorted(folder.iterdir()):
            parts = NAME.fullmatch(path.name)
            suffix = path.suffix.lower()
            if path.name.startswith(".") or suffix in COMPANIONS or not path.is_file():
                continue
            if parts is None or suffix not in suffixes:
                others.append(path.name)
                continue
            kind = parts["stem"], suffix
            files = found.setdefault(kind, {})
            number = int(parts["number"])
            if number in files:
                raise Refusal(f"{files[number].name} and {path.name} have the same number")
            files[number] = path
        if not found:
            raise Refusal("there are no numbered files in it, such as body_0001.ply")
        if len(found) > 1:
            names = [next(iter(files.values())).name for files in found.values()]
            raise Refusal(f"there are several sequences in it: those of {listed(names)}")
        if others:
            note(f"passed over, as they are no numbered meshes: {listed(others)}")
        (((stem, suffix), files),) = found.items()
        name = (stem.rstrip("_-. ") or folder.absolute().name) + suffix
        return cls(dict(sorted(files.items())), folder / name)

    @staticmethod
    def are_in(folder: Path, suffixes: Container[str]) -> bool:
        """Whether a folder holds a numbered file of such suffixes."""
        return any(
            NAME.fullmatch(path.name) and path.suffix.lower() in suffixes
            for path in folder.iterdir()
            if not path.name.startswith(".") and path.is_file()
        )

    def chosen(self, frames: list[int] | None) -> dict[int, Path]:
        """The files of some frames, or all of them; raises Refusal if there is none of a frame."""
        if frames is None:
            return dict(self.files)
        missing = [frame for frame in frames if frame not in self.files]
        if missing:
            raise Refusal(f"there is no file of frame {missing[0]} in it")
        return {frame: self.files[frame] for frame in frames}


def numbered(path: Path, number: int) -> Path:
    """The file of a number of a sequence that is named like ``path``."""
    return path.with_stem(f"{path.stem}_{number:0{DIGITS}d}")
