"""Whether files of single shapes are whole."""

from pathlib import Path

from spectral_tv.files import ply as plys
from spectral_tv.files.torn import Torn, last, require, take


def ply(path: Path) -> None:
    """A PLY file has as many items as its header says."""
    try:
        header = plys.read_header(path)
    except plys.NoHeader as error:
        raise Torn(str(error)) from error
    size = path.stat().st_size
    with path.open("rb") as file:
        file.seek(header.start)
        if header.format == "ascii":
            lines = sum(1 for line in file if line.strip() and line.endswith(b"\n"))
            expected = sum(element.count for element in header.elements)
            require(lines >= expected, f"{lines} of {expected} lines")
            return
        for element in header.elements:
            is_there = plys.skip(file, element, header.order) and file.tell() <= size
            require(is_there, f"not {element.count} of {element.name}")


def stl(path: Path) -> None:
    """A binary STL file is as long as its number of triangles says; a text one ends as such."""
    size = path.stat().st_size
    with path.open("rb") as file:
        start = file.read(80)
        is_text = start.lstrip().startswith(b"solid")
        triangles = take(file, "<I")[0] if size >= 84 or not is_text else None
    if triangles is not None and size == 84 + 50 * triangles:
        return
    require(is_text, f"{size} bytes for {triangles} triangles")
    lines = last(path, 1000).splitlines() or [b""]
    require(lines[-1].lstrip().startswith(b"endsolid"), "it has no end")


def obj(path: Path) -> None:
    """An OBJ file ends with a line; it does not say how many it has."""
    require(last(path, 1) == b"\n", "its last line has no end")
