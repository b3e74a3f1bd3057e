"""What the headers of all formats are read into."""

from dataclasses import field

from spectral_tv.dataclass import dataclass

AS_RGB = "its CMYK colors are read as red, green and blue"


class Unreadable(Exception):
    """A file would be misread; the message says why."""


@dataclass(frozen=True)
class Header:
    """What a picture file says of itself."""

    # As people call it, such as "PNG".
    format: str
    # "8", "16", "half" or "float"; the next larger one where there is no such depth.
    depth: str
    is_grey: bool
    has_alpha: bool
    # Whether colors are multiplied by alpha.
    is_associated: bool = False
    # How the picture has to be turned to be upright, as EXIF counts: 1 is upright already.
    orientation: int = 1
    # An ICC profile.
    profile: bytes | None = None
    # Pixels per metre, across and down.
    resolution: tuple[float, float] | None = None
    # Attributes of OpenEXR that say what the colors mean, by name: type and value.
    color_attributes: dict[str, tuple[bytes, bytes]] = field(default_factory=dict)
    # What is in the file and is not read, such as "EXIF data".
    unread: tuple[str, ...] = ()
    # Sentences about what is read as something else.
    remarks: tuple[str, ...] = ()
