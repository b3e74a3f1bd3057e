"""The header of an OpenEXR file."""

import struct

from spectral_tv.files.headers.header import Header, Unreadable
from spectral_tv.files.torn import Torn

TILED, DEEP, PARTS = 0x200, 0x800, 0x1000
HALF = 1
COLORS = ("R", "G", "B", "Y")
# What says what the colors mean.
MEANING = ("chromaticities", "colorInteropID", "whiteLuminance", "adoptedNeutral")


def read(data: bytes) -> Header:
    """Read the header of an OpenEXR file."""
    (version,) = struct.unpack_from("<I", data, 4)
    if version & (DEEP | PARTS):
        raise Unreadable(
            "it has several layers or deep pixels; save one layer as an image of its own"
        )
    found, end = attributes(data)
    channels = _channels(found["channels"][1])
    if any("." in name for name in channels):
        raise Unreadable("it has several layers; save one layer as an image of its own")
    colors = {name: kind for name, kind in channels.items() if name in COLORS}
    if not colors:
        raise Unreadable(f"its channels {', '.join(channels)} are no colors")
    require_pixels(data, end, bool(version & TILED))
    others = [name for name in channels if name not in (*COLORS, "A")]
    unread = [f"its channels {', '.join(others)}"] if others else []
    if found["dataWindow"] != found["displayWindow"]:
        unread.append("where its pixels are in a larger frame")
    return Header(
        format="OpenEXR",
        depth="half" if all(kind == HALF for kind in colors.values()) else "float",
        is_grey=len(colors) == 1,
        has_alpha="A" in channels,
        is_associated=True,
        color_attributes={name: found[name] for name in MEANING if name in found},
        unread=tuple(unread),
    )


def attributes(data: bytes) -> tuple[dict[str, tuple[bytes, bytes]], int]:
    """Types and values by name, and where the header ends."""
    found, place = {}, 8
    while data[place]:
        name, place = _word(data, place)
        kind, place = _word(data, place)
        (size,) = struct.unpack_from("<I", data, place)
        found[name.decode("latin-1")] = kind, data[place + 4 : place + 4 + size]
        place += 4 + size
    return found, place + 1


def starts(data: bytes, end: int) -> list[int]:
    """Where the pixels' parts begin, by the table after the header, which ends at ``end``."""
    found: list[int] = []
    first = len(data)
    while end + 8 * len(found) < first:  # the first part follows the table
        found.append(struct.unpack_from("<Q", data, end + 8 * len(found))[0])
        first = min(first, found[-1])
    return found


def _channels(data: bytes) -> dict[str, int]:
    """The types of the pixels by the names of the channels."""
    found, place = {}, 0
    while data[place]:
        name, place = _word(data, place)
        (found[name.decode("latin-1")],) = struct.unpack_from("<I", data, place)
        place += 16
    return found


def _word(data: bytes, place: int) -> tuple[bytes, int]:
    end = data.index(b"\0", place)
    return data[place:end], end + 1


def require_pixels(data: bytes, end: int, is_tiled: bool) -> None:
    """Raise Torn unless all of the pixels' parts are there."""
    table = starts(data, end)
    if not all(table):
        raise Torn("it is cut short")
    size = max(table) + (16 if is_tiled else 4)
    if size + 4 > len(data) or size + 4 + struct.unpack_from("<I", data, size)[0] > len(data):
        raise Torn("it is cut short: pixels are missing")
