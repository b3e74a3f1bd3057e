"""The header of a PNG file."""

import struct
import zlib
from collections.abc import Iterator

from spectral_tv.files.headers.header import Header
from spectral_tv.files.headers.tiff import orientation_of, tells_more
from spectral_tv.files.torn import Torn

GREY, GREY_ALPHA, COLOR_ALPHA = 0, 4, 6
METRE = 1
# What is assumed of a file that does not tell its gamma: 1/2.2, times 100000.
USUAL_GAMMA = 45455
UNREAD = {
    b"tEXt": "texts",
    b"zTXt": "texts",
    b"iTXt": "texts",
    b"acTL": "all but the first of its pictures",
    b"cICP": "its color description (cICP)",
}


def read(data: bytes) -> Header:
    """Read the header of a PNG file."""
    parts = dict(_chunks(data))
    depth, kind = parts[b"IHDR"][8:10]
    unread = [text for name, text in UNREAD.items() if name in parts]
    exif = parts.get(b"eXIf", b"")
    if tells_more(exif):
        unread.append("EXIF data")
    profile = None
    if b"iCCP" in parts:
        profile = zlib.decompress(parts[b"iCCP"].split(b"\0", 1)[1][1:])
    elif b"gAMA" in parts and b"sRGB" not in parts:
        (gamma,) = struct.unpack(">I", parts[b"gAMA"])
        if abs(gamma - USUAL_GAMMA) > USUAL_GAMMA / 100:
            unread.append(f"its gamma of {gamma / 100000:g}")
    return Header(
        format="PNG",
        depth="16" if depth == 16 else "8",
        is_grey=kind in (GREY, GREY_ALPHA),
        has_alpha=kind in (GREY_ALPHA, COLOR_ALPHA) or b"tRNS" in parts,
        orientation=orientation_of(exif),
        profile=profile,
        resolution=_resolution(parts.get(b"pHYs")),
        unread=tuple(dict.fromkeys(unread)),
    )


def _chunks(data: bytes) -> Iterator[tuple[bytes, bytes]]:
    place, name = 8, b""
    while name != b"IEND":
        if place + 12 > len(data):
            raise Torn("it is cut short")
        length, name = struct.unpack_from(">I4s", data, place)
        place += 12 + length
        yield name, data[place - 4 - length : place - 4]


def _resolution(physical: bytes | None) -> tuple[float, float] | None:
    if physical is None:
        return None
    across, down, unit = struct.unpack(">IIB", physical)
    return (across, down) if unit == METRE and across and down else None
