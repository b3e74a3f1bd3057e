"""The header of a WebP file."""

import struct
from collections.abc import Iterator

from spectral_tv.files.headers.header import Header, Unreadable
from spectral_tv.files.headers.tiff import orientation_of, tells_more
from spectral_tv.files.torn import Torn

ANIMATED, ALPHA = 0x02, 0x10


def read(data: bytes) -> Header:
    """Read the header of a WebP file."""
    parts = dict(_chunks(data))
    flags = parts[b"VP8X"][0] if b"VP8X" in parts else 0
    if flags & ANIMATED:
        raise Unreadable("it is animated, which is not read")
    if b"VP8L" in parts:
        (bits,) = struct.unpack_from("<I", parts[b"VP8L"], 1)
        has_alpha = bool(bits >> 28 & 1)
    else:
        has_alpha = bool(flags & ALPHA)
    exif = parts.get(b"EXIF", b"").removeprefix(b"Exif\0\0")
    told = (("EXIF data", tells_more(exif)), ("XMP data", b"XMP " in parts))
    return Header(
        format="WebP",
        depth="8",
        is_grey=False,
        has_alpha=has_alpha,
        orientation=orientation_of(exif),
        profile=parts.get(b"ICCP"),
        unread=tuple(text for text, is_there in told if is_there),
    )


def _chunks(data: bytes) -> Iterator[tuple[bytes, bytes]]:
    (length,) = struct.unpack_from("<I", data, 4)
    if len(data) < length + 8:
        raise Torn("it is cut short")
    place = 12
    while place + 8 <= length + 8:
        name, size = struct.unpack_from("<4sI", data, place)
        yield name, data[place + 8 : place + 8 + size]
        place += 8 + size + size % 2
