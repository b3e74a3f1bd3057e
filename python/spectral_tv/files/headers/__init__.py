"""The headers of picture files, of which Blender tells little."""

import struct
import zlib
from pathlib import Path

from spectral_tv.files.headers import exr, jpeg, png, tiff, webp
from spectral_tv.files.headers.header import Header, Unreadable
from spectral_tv.files.torn import Torn

# How files begin, whatever their suffix.
STARTS = {
    b"\x89PNG": png.read,
    b"\xff\xd8": jpeg.read,
    b"RIFF": webp.read,
    b"II*\0": tiff.read,
    b"MM\0*": tiff.read,
    b"\x76\x2f\x31\x01": exr.read,
}


def read_header(path: Path) -> Header | None:
    """Read the header of a picture; None of a format that is not known here.

    Raises Torn if the file is cut short, Unreadable if it would be misread, and OSError.
    """
    data = path.read_bytes()
    if not data:
        raise Torn("it is empty")
    for start, read in STARTS.items():
        if data.startswith(start):
            try:
                return read(data)
            except (LookupError, ValueError, OverflowError, struct.error, zlib.error) as error:
                raise Torn("its header makes no sense") from error
    return None


__all__ = ["Header", "Torn", "Unreadable", "read_header"]
