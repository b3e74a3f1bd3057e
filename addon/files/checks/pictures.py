"""Whether pictures are whole."""

import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

import numpy as np

from .torn import last, require, take

TIFF_TAGS = (273, 279, 324, 325)


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
    """All pixels that a TIFF refers to are within it."""
    size = path.stat().st_size
    with path.open("rb") as file:
        order = {b"II": "<", b"MM": ">"}.get(file.read(2), "")
        require(bool(order), "it does not begin like a .tif")
        version, place = take(file, f"{order}HI")
        require(version == 42, "it is a .tif of another kind")
        while place:
            file.seek(place)
            (count,) = take(file, f"{order}H")
            found = [take(file, f"{order}HHI4s") for _ in range(count)]
            (place,) = take(file, f"{order}I")
            # Where strips or tiles begin, and how long they are.
            tags = {tag: _numbers(file, order, *rest) for tag, *rest in found if tag in TIFF_TAGS}
            for starts, lengths in ((273, 279), (324, 325)):
                ends = map(sum, zip(tags.get(starts, ()), tags.get(lengths, ()), strict=True))
                require(all(end <= size for end in ends), "pixels are missing")


def _numbers(file: BinaryIO, order: str, kind: int, count: int, value: bytes) -> tuple[int, ...]:
    """The numbers of a tag of a TIFF: the value itself, or what it tells the place of."""
    layout = f"{order}{count}{'B' if kind == 1 else 'H' if kind == 3 else 'I'}"
    if struct.calcsize(layout) <= 4:
        return struct.unpack_from(layout, value)
    file.seek(struct.unpack(f"{order}I", value)[0])
    return take(file, layout)


def exr(path: Path) -> None:
    """An OpenEXR file has a table of its parts, which is filled in at the end."""
    data = np.fromfile(path, np.uint8).tobytes()
    require(data[:4] == b"\x76\x2f\x31\x01", "it does not begin like an .exr")
    version, place = int.from_bytes(data[4:8], "little"), 8
    parts: list[dict[str, bytes]] = []
    attributes: dict[str, bytes] = {}
    while True:
        name, place = _word(data, place)
        if not name:
            if attributes:
                parts.append(attributes)
            if not version & 0x1000 or not attributes:
                break
            attributes = {}
            continue
        _, place = _word(data, place)
        require(place + 4 <= len(data), "its header is cut off")
        length = int.from_bytes(data[place : place + 4], "little")
        attributes[name] = data[place + 4 : place + 4 + length]
        place += 4 + length
    if version & 0x200 or any("tiles" in part for part in parts):  # tiles have tables by level
        require(len(data) > place, "its pixels are missing")
        return
    for part in parts:
        low, high = np.frombuffer(part["dataWindow"], "<i4")[[1, 3]]
        lines = {0: 1, 1: 1, 2: 1, 3: 16, 4: 32, 5: 16, 6: 32, 7: 32, 8: 32, 9: 256}
        count = -(-(int(high) - int(low) + 1) // lines[part["compression"][0]])
        table = np.frombuffer(data[place : place + 8 * count], "<u8")
        require(len(table) == count and bool((table > 0).all()), "its table is not whole")
        place += 8 * count
        at = int(table.max()) + (4 if version & 0x1000 else 0)
        require(at + 8 <= len(data), "its pixels are missing")
        length = int.from_bytes(data[at + 4 : at + 8], "little")
        require(at + 8 + length <= len(data), "its last pixels are missing")


def _word(data: bytes, place: int) -> tuple[str, int]:
    end = data.find(b"\0", place)
    require(end >= 0, "its header is cut off")
    return data[place:end].decode("ascii", "replace"), end + 1


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
