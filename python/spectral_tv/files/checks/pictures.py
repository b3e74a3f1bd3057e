"""Whether pictures are whole."""

import struct
import zlib
from collections.abc import Callable
from pathlib import Path

from spectral_tv.files.headers.exr import PARTS, TILED, attributes, require_pixels
from spectral_tv.files.headers.tiff import Directory
from spectral_tv.files.torn import last, require, take


def png(path: Path) -> None:
    """A PNG goes on part by part, each with its checksum, to one that says it is the last."""
    with path.open("rb") as file:
        require(file.read(8) == b"\x89PNG\r\n\x1a\n", "it does not begin like a .png")
        while True:
            length, kind = take(file, ">I4s")
            data = file.read(length)
            require(len(data) == length, f"it ends at byte {file.tell()}")
            (checksum,) = take(file, ">I")
            require(zlib.crc32(kind + data) == checksum, "a checksum is wrong")
            if kind == b"IEND":
                return


def jpeg(path: Path) -> None:
    """A JPEG ends with a mark of its own."""
    with path.open("rb") as file:
        require(file.read(2) == b"\xff\xd8", "it does not begin like a .jpg")
    require(last(path, 2) == b"\xff\xd9", "its end is missing")


def webp(path: Path) -> None:
    """A WebP says how long it is."""
    with path.open("rb") as file:
        magic, length, kind = take(file, "<4sI4s")
    require((magic, kind) == (b"RIFF", b"WEBP"), "it does not begin like a .webp")
    size = path.stat().st_size
    require(size >= length + 8, f"{size} bytes of {length + 8}")


def bmp(path: Path) -> None:
    """A BMP says where its pixels are, and how many."""
    with path.open("rb") as file:
        magic, _, _, start, _, width, height, _, bits = take(file, "<2sIIIIiiHH")
    require(magic == b"BM", "it does not begin like a .bmp")
    size, expected = path.stat().st_size, start + (width * bits + 31) // 32 * 4 * abs(height)
    require(size >= expected, f"{size} bytes of {expected}")


def tga(path: Path) -> None:
    """A Targa file has as many pixels as it says, in runs or one by one."""
    with path.open("rb") as file:
        name, map_kind, kind, _, map_size, map_bits, _, _, width, height, bits, _ = take(
            file, "<BBBHHBHHHHBB"
        )
        file.seek(name + (map_size * map_bits // 8 if map_kind else 0), 1)
        data = file.read()
    pixel, count, place = (bits + 7) // 8, width * height, 0
    if kind < 8:
        require(len(data) >= pixel * count, f"{len(data)} bytes of {pixel * count}")
        return
    while count > 0:
        require(place < len(data), f"{count} pixels are missing")
        run = (data[place] & 127) + 1
        place += 1 + pixel * (1 if data[place] & 128 else run)
        count -= run
    require(place <= len(data), "its last pixels are missing")


def tiff(path: Path) -> None:
    """All pixels that the pages of a TIFF refer to are within it."""
    data = path.read_bytes()
    require(data[:4] in (b"II*\0", b"MM\0*"), "it does not begin like a .tif")
    place = 0
    while True:
        page = Directory(data, place)
        page.require_pixels()
        place = page.next
        if not place:
            return


def exr(path: Path) -> None:
    """An OpenEXR file has a table of its parts, which is filled in at the end."""
    data = path.read_bytes()
    require(data[:4] == b"\x76\x2f\x31\x01", "it does not begin like an .exr")
    (version,) = struct.unpack_from("<I", data, 4)
    _, end = attributes(data)
    if version & PARTS:  # headers and tables of several
        require(len(data) > end, "its pixels are missing")
    else:
        require_pixels(data, end, bool(version & TILED))


STARTS: dict[bytes, Callable[[Path], None]] = {
    b"\x89PNG": png,
    b"\xff\xd8": jpeg,
    b"RIFF": webp,
    b"BM": bmp,
    b"II": tiff,
    b"MM": tiff,
    b"\x76\x2f\x31\x01": exr,
}


def by_start(path: Path) -> None:
    """Check a picture by how it begins, whatever its suffix."""
    with path.open("rb") as file:
        start = file.read(4)
    require(bool(start), f"{path.name} is empty")
    for mark, test in STARTS.items():
        if start.startswith(mark):
            test(path)
