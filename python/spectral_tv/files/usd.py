"""The units and the upward axis of a USD file, which Blender's importer does not tell."""

import re
import struct
import zipfile
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

# Types of values, as numbers in the binary files.
DOUBLE, TOKEN = 9, 11
INLINED, PAYLOAD = 1 << 62, (1 << 48) - 1
HEADER = re.compile(r"^#usda.*?^\)", re.DOTALL | re.MULTILINE)


def metadata(path: Path) -> dict[str, Any]:
    """What the file says of ``upAxis``, "Y" or "Z", and of ``metersPerUnit``, as far as it does."""
    try:
        return _metadata(path)
    except (OSError, ValueError, LookupError, struct.error, zipfile.BadZipFile):
        return {}


def _metadata(path: Path) -> dict[str, Any]:
    if path.suffix.lower() == ".usdz":
        with zipfile.ZipFile(path) as archive, TemporaryDirectory() as folder:
            return _metadata(Path(archive.extract(archive.namelist()[0], folder)))
    with path.open("rb") as file:
        start = file.read(8)
    if start == b"PXR-USDC":
        return _of_crate(path.read_bytes())
    with path.open(encoding="utf-8", errors="replace") as text:
        found = HEADER.match(text.read(65536))
    head = found[0] if found else ""
    result: dict[str, Any] = {}
    if axis := re.search(r'^\s*upAxis\s*=\s*"([YZ])"', head, re.MULTILINE):
        result["upAxis"] = axis[1]
    if unit := re.search(r"^\s*metersPerUnit\s*=\s*([\d.eE+-]+)", head, re.MULTILINE):
        result["metersPerUnit"] = float(unit[1])
    return result


def _of_crate(data: bytes) -> dict[str, Any]:
    """Read the fields of these names in a binary file."""
    (table,) = struct.unpack_from("<q", data, 16)
    (count,) = struct.unpack_from("<Q", data, table)
    places = {}
    for number in range(count):
        name, start, size = struct.unpack_from("<16sqq", data, table + 8 + 32 * number)
        places[name.rstrip(b"\0")] = data[start : start + size]
    words = _tokens(places[b"TOKENS"])
    fields = places[b"FIELDS"]
    number, packed = struct.unpack_from("<QQ", fields)
    names = _integers(_unpack(fields[16 : 16 + packed], 5 * number + 8), number)
    (length,) = struct.unpack_from("<Q", fields, 16 + packed)
    values = _unpack(fields[24 + packed : 24 + packed + length], 8 * number)
    result: dict[str, Any] = {}
    for place, name in enumerate(names):
        word = words[name]
        (value,) = struct.unpack_from("<Q", values, 8 * place)
        kind, payload = (value >> 48) & 0xFF, value & PAYLOAD
        if word == "upAxis" and kind == TOKEN:
            result[word] = words[payload]
        elif word == "metersPerUnit" and kind == DOUBLE:
            if value & INLINED:
                (result[word],) = struct.unpack("<f", struct.pack("<I", payload & 0xFFFFFFFF))
            else:
                (result[word],) = struct.unpack_from("<d", data, payload)
    return result


def _tokens(section: bytes) -> list[str]:
    _, size, packed = struct.unpack_from("<QQQ", section)
    text = _unpack(section[24 : 24 + packed], size)
    return [word.decode("utf-8", "replace") for word in text.split(b"\0")]


def _unpack(data: bytes, most: int) -> bytes:
    """Undo the compression of a section: LZ4 in one or more parts."""
    if data[0] == 0:
        return _lz4(data[1:], most)
    parts, place = [], 1
    for _ in range(data[0]):
        (size,) = struct.unpack_from("<i", data, place)
        parts.append(_lz4(data[place + 4 : place + 4 + size], most))
        place += 4 + size
    return b"".join(parts)


def _lz4(data: bytes, most: int) -> bytes:
    """Undo LZ4's block compression."""
    out = bytearray()
    place = 0

    def length(start: int) -> int:
        nonlocal place
        total = start
        if start == 15:
            more = 255
            while more == 255:
                more = data[place]
                place += 1
                total += more
        return total

    while place < len(data) and len(out) <= most:
        mark = data[place]
        place += 1
        count = length(mark >> 4)
        out += data[place : place + count]
        place += count
        if place >= len(data):
            break
        back = data[place] | data[place + 1] << 8
        place += 2
        count = length(mark & 15) + 4
        for _ in range(count):  # what is copied may overlap itself
            out.append(out[-back])
    return bytes(out)


def _integers(data: bytes, count: int) -> list[int]:
    """Undo the coding of whole numbers: by their differences, of which one is common."""
    (common,) = struct.unpack_from("<i", data)
    codes = data[4 : 4 + (2 * count + 7) // 8]
    place, value, result = 4 + len(codes), 0, []
    for number in range(count):
        code = codes[number // 4] >> (2 * (number % 4)) & 3
        if code == 0:
            value += common
        else:
            layout = {1: "<b", 2: "<h", 3: "<i"}[code]
            value += struct.unpack_from(layout, data, place)[0]
            place += struct.calcsize(layout)
        result.append(value)
    return result
