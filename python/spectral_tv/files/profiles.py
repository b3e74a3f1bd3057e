"""ICC profiles: their names, and what channels they are for."""

import struct

SPACES = {b"GRAY": ("BW", "BWA"), b"RGB ": ("RGB", "RGBA")}
DESCRIPTION, ASCII, UNICODE = b"desc", b"desc", b"mluc"


def fits(profile: bytes, channels: str) -> bool:
    """Whether a profile is for channels such as BW or RGBA."""
    return channels in SPACES.get(profile[16:20], ())


def name_of(profile: bytes) -> str:
    """The name that a profile gives itself; empty if it gives none."""
    try:
        return _name(profile)
    except (LookupError, UnicodeError, struct.error):
        return ""


def _name(profile: bytes) -> str:
    (count,) = struct.unpack_from(">I", profile, 128)
    for index in range(count):
        tag, start, size = struct.unpack_from(">4sII", profile, 132 + 12 * index)
        if tag != DESCRIPTION:
            continue
        data = profile[start : start + size]
        if data.startswith(ASCII):
            (length,) = struct.unpack_from(">I", data, 8)
            return data[12 : 12 + length].rstrip(b"\0").decode("ascii")
        if data.startswith(UNICODE):
            length, place = struct.unpack_from(">II", data, 20)
            return data[place : place + length].decode("utf-16-be")
    return ""
