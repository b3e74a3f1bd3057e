"""The header of a TIFF file, and of EXIF data, which are of the same kind."""

import struct
from collections.abc import Iterator

from spectral_tv.files.headers.header import AS_RGB, Header, Unreadable
from spectral_tv.files.torn import Torn

WIDTHS = {1: 1, 2: 1, 3: 2, 4: 4, 5: 8, 6: 1, 7: 1, 8: 2, 9: 4, 10: 8, 11: 4, 12: 8}
LETTERS = {1: "B", 3: "H", 4: "I", 6: "b", 8: "h", 9: "i", 11: "f", 12: "d"}
RATIONAL = 5
BITS, PHOTOMETRIC, ORIENTATION, SAMPLES = 258, 262, 274, 277
STRIPS, TILES = (273, 279), (324, 325)
RESOLUTION, UNIT = (282, 283), 296
EXTRA, FORMAT = 338, 339
XMP, IPTC, EXIF, PROFILE = 700, 33723, 34665, 34675
UNSIGNED, SIGNED, REAL = 1, 2, 3
# What is neither, nor of unknown kind.
COMPLEX = {5: "integers", 6: "floats"}
# Of integers, and of floats.
MOST_BITS = 16
SINGLE = 32
ASSOCIATED = 1
CMYK, PALETTE = 5, 3
# What the picture itself tells, or is heeded.
KNOWN = {256, 257, ORIENTATION, *RESOLUTION, UNIT, 531}
# Metres of the units of resolution.
METRES = {2: 0.0254, 3: 0.01}


class Directory:
    """The tags of a page, the first one if no place is named."""

    def __init__(self, data: bytes, place: int = 0) -> None:
        """Read the tags; raises Torn or what ``struct`` does."""
        self._data = data
        self._order = {b"II": "<", b"MM": ">"}[data[:2]]
        if not place:
            (place,) = struct.unpack_from(f"{self._order}I", data, 4)
        (count,) = struct.unpack_from(f"{self._order}H", data, place)
        self._entries: dict[int, tuple[int, int, int]] = {}
        for index in range(count):
            at = place + 2 + 12 * index
            tag, kind, length = struct.unpack_from(f"{self._order}HHI", data, at)
            size = WIDTHS.get(kind, 1) * length
            where = at + 8
            if size > 4:
                (where,) = struct.unpack_from(f"{self._order}I", data, where)
            if where + size > len(data):
                raise Torn("its header is cut off")
            self._entries[tag] = kind, length, where
        (self.next,) = struct.unpack_from(f"{self._order}I", data, place + 2 + 12 * count)

    def __contains__(self, tag: int) -> bool:
        """Whether the page has the tag."""
        return tag in self._entries

    @property
    def tags(self) -> set[int]:
        """All tags that the page has."""
        return set(self._entries)

    def numbers(self, tag: int, default: float | None = None) -> tuple[float, ...]:
        """The numbers of a tag; the default, if there is one, of a tag that is not there."""
        if tag not in self._entries:
            return () if default is None else (default,)
        kind, length, where = self._entries[tag]
        if kind == RATIONAL:
            found = struct.unpack_from(f"{self._order}{2 * length}I", self._data, where)
            return tuple(a / b if b else 0.0 for a, b in zip(found[::2], found[1::2], strict=True))
        return struct.unpack_from(f"{self._order}{length}{LETTERS[kind]}", self._data, where)

    def bytes(self, tag: int) -> bytes | None:
        """The bytes of a tag."""
        if tag not in self._entries:
            return None
        kind, length, where = self._entries[tag]
        return self._data[where : where + WIDTHS.get(kind, 1) * length]

    def require_pixels(self) -> None:
        """Raise Torn unless all pixels are there, in strips or in tiles."""
        for starts, lengths in (STRIPS, TILES):
            ends = map(sum, zip(self.numbers(starts), self.numbers(lengths), strict=True))
            if any(end > len(self._data) for end in ends):
                raise Torn("it is cut short: pixels are missing")


def orientation_of(exif: bytes) -> int:
    """The orientation that EXIF data tell, which begin like a TIFF file; 1 if they tell none."""
    try:
        return _orientation(Directory(exif))
    except (Torn, LookupError, struct.error):
        return 1


def tells_more(exif: bytes) -> bool:
    """Whether EXIF data tell anything that a picture does not tell without them."""
    try:
        return bool(Directory(exif).tags - KNOWN)
    except (Torn, LookupError, struct.error):
        return bool(exif)


def read(data: bytes) -> Header:
    """Read the header of a TIFF file."""
    page = Directory(data)
    samples = int(page.numbers(SAMPLES, 1)[0])
    bits = int(max(page.numbers(BITS, 1)))
    kind = int(page.numbers(FORMAT, UNSIGNED)[0])
    photometric = page.numbers(PHOTOMETRIC, 1)[0]
    if bits < 8:
        raise Unreadable(f"its values have {bits} bits, which is misread; give them 8")
    _require_values(kind, bits)
    page.require_pixels()
    colors = 1 if photometric <= 1 else 4 if photometric == CMYK else 3
    if photometric == PALETTE:
        samples += 2
    extra = page.numbers(EXTRA)
    unread = [
        text
        for tag, text in ((XMP, "XMP data"), (IPTC, "IPTC data"), (EXIF, "EXIF data"))
        if tag in page
    ]
    if page.next:
        unread.append("its further pages")
    if samples > colors + 1:
        unread.append(f"{samples - colors - 1} of its {samples} channels")
    return Header(
        format="TIFF",
        depth=_depth(kind, bits),
        is_grey=colors == 1,
        has_alpha=samples > colors and colors != 4,
        is_associated=bool(extra) and extra[0] == ASSOCIATED,
        orientation=_orientation(page),
        profile=page.bytes(PROFILE),
        resolution=_resolution(page),
        unread=tuple(unread),
        remarks=tuple(_remarks(photometric, kind, bits)),
    )


def _require_values(kind: int, bits: int) -> None:
    """Raise Unreadable of values that Blender makes others of: fractions of the largest ones."""
    if kind in COMPLEX:
        raise Unreadable(f"its values are complex {COMPLEX[kind]}, which are no colors")
    if kind == SIGNED or (kind == UNSIGNED and bits > MOST_BITS):
        sign = "signed " if kind == SIGNED else ""
        raise Unreadable(
            f"its values are {sign}integers of {bits} bits, which is misread; save it with "
            "floats of 32 bits, or positive integers of 16"
        )


def _remarks(photometric: float, kind: int, bits: int) -> Iterator[str]:
    if photometric == CMYK:
        yield AS_RGB
    if kind == REAL and bits > SINGLE:
        yield f"its floats of {bits} bits are read with {SINGLE}"


def _depth(kind: int, bits: int) -> str:
    if kind == UNSIGNED and bits <= 16:
        return "8" if bits == 8 else "16"
    return "half" if (kind, bits) == (REAL, 16) else "float"


def _orientation(page: Directory) -> int:
    found = int(next(iter(page.numbers(ORIENTATION, 1)), 1))
    return found if 1 <= found <= 8 else 1


def _resolution(page: Directory) -> tuple[float, float] | None:
    metres = METRES.get(int(page.numbers(UNIT, 2)[0]))
    found = tuple(_positive(page))
    if metres is None or len(found) != 2:
        return None
    return found[0] / metres, found[1] / metres


def _positive(page: Directory) -> Iterator[float]:
    for tag in RESOLUTION:
        yield from (value for value in page.numbers(tag)[:1] if value > 0)
