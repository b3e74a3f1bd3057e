"""Writing TIFF files.

Blender writes none with floats or with grey and alpha, and takes straight colors of 16 bits for
premultiplied ones.
"""

from __future__ import annotations

import struct
import zlib
from pathlib import Path
from typing import TYPE_CHECKING

from spectral_tv.dataclass import dataclass
from spectral_tv.later import np

if TYPE_CHECKING:
    from numpy.typing import NDArray

SHORT, LONG, RATIONAL, BYTES = 3, 4, 5, 7
DEFLATE, INCH = 8, 2
GREY, RGB = 1, 2
ASSOCIATED, STRAIGHT = 1, 2
UNSIGNED, REAL = 1, 3
METRES_PER_INCH = 0.0254
# Bytes of a strip before it is compressed, about, and of a file at most.
STRIP, LARGEST = 1 << 20, (1 << 32) - 1


@dataclass(frozen=True)
class Meaning:
    """What the channels are, and what else the file tells."""

    has_alpha: bool
    # Whether colors are multiplied by alpha.
    is_associated: bool
    # Pixels per metre, across and down.
    resolution: tuple[float, float] | None = None
    # An ICC profile.
    profile: bytes | None = None


def write_tiff(path: Path, pixels: NDArray[np.generic], meaning: Meaning) -> None:
    """Write (H, W, C) uint8, uint16 or float32 from the top down; C is 1 or 3, and alpha.

    Raises ValueError if the file would be larger than a TIFF can be, and OSError.
    """
    height, width, channels = pixels.shape
    little = np.ascontiguousarray(pixels, dtype=pixels.dtype.newbyteorder("<"))
    rows = max(1, STRIP // (width * channels * little.itemsize))
    strips = [zlib.compress(little[row : row + rows].tobytes()) for row in range(0, height, rows)]
    starts = [8]
    for strip in strips:
        starts.append(starts[-1] + len(strip) + len(strip) % 2)
    if starts[-1] + (1 << 24) > LARGEST:
        raise ValueError("a .tif holds at most 4 GB")
    entries = [
        (256, LONG, [width]),
        (257, LONG, [height]),
        (258, SHORT, [8 * little.itemsize] * channels),
        (259, SHORT, [DEFLATE]),
        (262, SHORT, [GREY if channels < 3 else RGB]),
        (273, LONG, starts[:-1]),
        (277, SHORT, [channels]),
        (278, LONG, [rows]),
        (279, LONG, [len(strip) for strip in strips]),
        (284, SHORT, [1]),
        (339, SHORT, [REAL if little.dtype.kind == "f" else UNSIGNED] * channels),
    ]
    if meaning.has_alpha:
        entries.append((338, SHORT, [ASSOCIATED if meaning.is_associated else STRAIGHT]))
    if meaning.resolution is not None:
        across, down = (_tenthousandths(each * METRES_PER_INCH) for each in meaning.resolution)
        entries += [
            (282, RATIONAL, [across, 10000]),
            (283, RATIONAL, [down, 10000]),
            (296, SHORT, [INCH]),
        ]
    if meaning.profile is not None:
        entries.append((34675, BYTES, list(meaning.profile)))
    with path.open("wb") as file:
        file.write(struct.pack("<2sHI", b"II", 42, starts[-1]))
        for strip in strips:
            file.write(strip + b"\0" * (len(strip) % 2))
        file.write(_directory(sorted(entries), starts[-1]))


def _tenthousandths(value: float) -> int:
    return min(LARGEST, max(1, round(10000 * value)))


def _directory(entries: list[tuple[int, int, list[int]]], place: int) -> bytes:
    """The table of tags, which is at ``place``, and the values that have no room in it."""
    table, values = [struct.pack("<H", len(entries))], b""
    beyond = place + 2 + 12 * len(entries) + 4
    for tag, kind, numbers in entries:
        letter = {SHORT: "H", LONG: "I", RATIONAL: "I", BYTES: "B"}[kind]
        data = struct.pack(f"<{len(numbers)}{letter}", *numbers)
        count = len(numbers) // 2 if kind == RATIONAL else len(numbers)
        if len(data) > 4:
            where = struct.pack("<I", beyond + len(values))
            values += data + b"\0" * (len(data) % 2)
        else:
            where = data.ljust(4, b"\0")
        table.append(struct.pack("<HHI", tag, kind, count) + where)
    return b"".join(table) + struct.pack("<I", 0) + values
