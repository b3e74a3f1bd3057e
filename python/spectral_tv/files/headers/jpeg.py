"""The header of a JPEG file."""

import struct
from collections.abc import Iterator

from spectral_tv.files.headers.header import AS_RGB, Header
from spectral_tv.files.headers.tiff import METRES, orientation_of, tells_more
from spectral_tv.files.torn import Torn

APP0, APP1, APP2, SCAN = 0xE0, 0xE1, 0xE2, 0xDA
# Markers of frames, and those among them that are none.
FRAMES, OTHERS = range(0xC0, 0xD0), (0xC4, 0xC8, 0xCC)
ALONE = (0x01, *range(0xD0, 0xD9))
EXIF, XMP, ICC, JFIF = b"Exif\0\0", b"http://ns.adobe.com/", b"ICC_PROFILE\0", b"JFIF\0"
# What the units of JFIF are in TIFF.
INCH, CENTIMETRE = 1, 2


def read(data: bytes) -> Header:
    """Read the header of a JPEG file."""
    channels, orientation = 0, 1
    profile: dict[int, bytes] = {}
    resolution = None
    unread = []
    for marker, part in _segments(data):
        if marker in FRAMES and marker not in OTHERS:
            channels = part[5]
        elif marker == APP0 and part.startswith(JFIF):
            resolution = _resolution(part)
        elif marker == APP1 and part.startswith(EXIF):
            exif = part[len(EXIF) :]
            orientation = orientation_of(exif)
            if tells_more(exif):
                unread.append("EXIF data")
        elif marker == APP1 and part.startswith(XMP):
            unread.append("XMP data")
        elif marker == APP2 and part.startswith(ICC):
            profile[part[len(ICC)]] = part[len(ICC) + 2 :]
    return Header(
        format="JPEG",
        depth="8",
        is_grey=channels == 1,
        has_alpha=False,
        orientation=orientation,
        profile=b"".join(profile[number] for number in sorted(profile)) or None,
        resolution=resolution,
        unread=tuple(dict.fromkeys(unread)),
        remarks=(AS_RGB,) if channels == 4 else (),
    )


def _segments(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Markers and what follows them, up to the pixels."""
    place = 2
    while True:
        while data[place] == 0xFF and data[place + 1] == 0xFF:
            place += 1
        marker = data[place + 1]
        if marker in ALONE:
            place += 2
            continue
        (length,) = struct.unpack_from(">H", data, place + 2)
        yield marker, data[place + 4 : place + 2 + length]
        place += 2 + length
        if marker == SCAN:
            break
    if data.find(b"\xff\xd9", place) < 0:  # cameras append what is not of the picture
        raise Torn("it is cut short")


def _resolution(part: bytes) -> tuple[float, float] | None:
    unit, across, down = struct.unpack_from(">BHH", part, len(JFIF) + 2)
    if unit not in (INCH, CENTIMETRE) or not across or not down:
        return None
    metres = METRES[unit + 1]
    return across / metres, down / metres
