"""Adding tags to a finished picture file that Blender does not write beside its pixels."""

import struct
import zlib
from pathlib import Path

from spectral_tv.files.headers.exr import MEANING, attributes, starts

# Of the profile's bytes in one segment of a JPEG.
SEGMENT = 65519
INCH, METRES_PER_INCH = 1, 0.0254


def add_profile(path: Path, profile: bytes) -> None:
    """Add an ICC profile to a PNG or a JPEG that has none; raises OSError."""
    data = path.read_bytes()
    if data.startswith(b"\x89PNG"):
        end = 8 + 12 + 13  # of IHDR, which is the first
        added = _chunk(b"iCCP", b"ICC profile\0\0" + zlib.compress(profile))
    else:
        end = _end_of_jfif(data)
        parts = [profile[start : start + SEGMENT] for start in range(0, len(profile), SEGMENT)]
        added = b"".join(
            _segment(0xE2, b"ICC_PROFILE\0" + bytes([number, len(parts)]) + part)
            for number, part in enumerate(parts, start=1)
        )
    path.write_bytes(data[:end] + added + data[end:])


def set_jpeg_resolution(path: Path, resolution: tuple[float, float]) -> None:
    """Say in a JPEG how many pixels there are to a metre, across and down; raises OSError."""
    data = path.read_bytes()
    if data[6:11] != b"JFIF\0":
        return
    across, down = (min(65535, max(1, round(each * METRES_PER_INCH))) for each in resolution)
    path.write_bytes(data[:13] + struct.pack(">BHH", INCH, across, down) + data[18:])


def set_exr_meaning(path: Path, meaning: dict[str, tuple[bytes, bytes]]) -> None:
    """Exchange those attributes of an OpenEXR file that say what its colors mean.

    ``meaning`` has types and values by name. Raises OSError.
    """
    data = path.read_bytes()
    found, end = attributes(data)
    kept = {name: each for name, each in found.items() if name not in MEANING} | meaning
    header = data[:8]
    for name, (kind, value) in sorted(kept.items()):
        header += name.encode("latin-1") + b"\0" + kind + b"\0"
        header += struct.pack("<I", len(value)) + value
    header += b"\0"
    table, shift = starts(data, end), len(header) - end
    moved = struct.pack(f"<{len(table)}Q", *(start + shift for start in table))
    path.write_bytes(header + moved + data[end + len(moved) :])


def _chunk(name: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def _segment(marker: int, data: bytes) -> bytes:
    return struct.pack(">BBH", 0xFF, marker, len(data) + 2) + data


def _end_of_jfif(data: bytes) -> int:
    """Where the first segment of a JPEG ends, which has to stay the first."""
    if data[2:4] != b"\xff\xe0":
        return 2
    return 4 + struct.unpack_from(">H", data, 4)[0]
