"""Whether files of scenes are whole."""

import json
import re
import struct
import zipfile
from pathlib import Path
from typing import Any, BinaryIO
from urllib.parse import unquote
from xml.etree import ElementTree

from spectral_tv.files.checks.pictures import by_start
from spectral_tv.files.torn import Torn, last, require, take

FBX_END = bytes.fromhex("f85a8c6adef5d97eece90ce3758f290b")
ZSTANDARD, SEEKABLE, SKIPPED = 0xFD2FB528, 0x8F92EAB1, 0x184D2A5E
USDA_MARKS = re.compile(r'("""|\'\'\'|\\.|["\'@{}()\[\]]|#[^\n]*)')
SIZES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
COUNTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}


def blend(path: Path) -> None:
    """A .blend goes on block by block to one that says it is the last."""
    with path.open("rb") as file:
        magic = file.read(7)
        if magic != b"BLENDER":
            file.seek(0)
            return _compressed(file)
        # The size of pointers and the version; Blender 5 has the size of the header before them.
        mark = file.read(1)
        if mark.isdigit():
            size = int(mark + file.read(1))
            file.seek(size)
            layout, length = "<4siQqq", 3
        else:
            file.seek(12)
            layout, length = ("<4siIii", 1) if mark == b"_" else ("<4siQii", 1)
        size = path.stat().st_size
        while True:
            head = take(file, layout)
            if head[0] == b"ENDB":
                return None
            file.seek(head[length], 1)
            require(file.tell() <= size, f"it ends within a block at byte {size}")


def _compressed(file: BinaryIO) -> None:
    """Blender compresses in frames, whose sizes stand in a table at the end."""
    require(take(file, "<I")[0] == ZSTANDARD, "it does not begin like a .blend")
    size = file.seek(0, 2)
    require(size > 17, "it ends at once")
    file.seek(-9, 2)
    frames, _, mark = take(file, "<IBI")
    require(mark == SEEKABLE, "its table is missing")
    start = size - 9 - 8 * frames - 8
    require(start >= 0, "its table is cut off")
    file.seek(start)
    require(take(file, "<II") == (SKIPPED, 8 * frames + 9), "its table is cut off")
    sizes = [take(file, "<II")[0] for _ in range(frames)]
    require(sum(sizes) == start, f"{start} bytes for {sum(sizes)}")


def glb(path: Path) -> None:
    """A .glb is as long as it says, and holds what its JSON refers to."""
    with path.open("rb") as file:
        magic, _, length = take(file, "<4sII")
        require(magic == b"glTF", "it does not begin like a .glb")
        size = path.stat().st_size
        require(length == size, f"{size} bytes of {length}")
        chunks = {}
        while file.tell() < length:
            count, kind = take(file, "<I4s")
            chunks[kind] = file.tell(), count
            file.seek(count, 1)
        require(file.tell() == length and b"JSON" in chunks, "its parts are longer than it")
        start, count = chunks[b"JSON"]
        file.seek(start)
        content = _json(file.read(count))
    _refer(content, path, chunks.get(b"BIN\0", (0, 0))[1])


def gltf(path: Path) -> None:
    """A .gltf is JSON, and the files that it refers to are there and as long as it says."""
    _refer(_json(path.read_bytes()), path, None)


def _json(data: bytes) -> Any:
    try:
        return json.loads(data)
    except ValueError as error:
        raise Torn("its JSON is not whole") from error


def _refer(content: Any, path: Path, inside: int | None) -> None:
    """Check that all references of a glTF lie within its buffers."""
    sizes = []
    for number, buffer in enumerate(content.get("buffers", ())):
        length = buffer["byteLength"]
        if "uri" in buffer:
            if not buffer["uri"].startswith("data:"):
                other = path.parent / unquote(buffer["uri"])
                there = other.stat().st_size if other.is_file() else 0
                require(there >= length, f"{there} of {length} bytes in {other.name}")
        elif number == 0 and inside is not None:
            require(inside >= length, f"{inside} of {length} bytes")
        sizes.append(length)
    views = content.get("bufferViews", ())
    for view in views:
        end = view.get("byteOffset", 0) + view["byteLength"]
        require(end <= sizes[view["buffer"]], "a view beyond its buffer")
    for accessor in content.get("accessors", ()):
        if "bufferView" in accessor:
            view = views[accessor["bufferView"]]
            item = SIZES[accessor["componentType"]] * COUNTS[accessor["type"]]
            stride = view.get("byteStride", item)
            end = accessor.get("byteOffset", 0) + stride * (accessor["count"] - 1) + item
            require(end <= view["byteLength"], "numbers beyond their view")
    for image in content.get("images", ()):
        if "uri" in image and not image["uri"].startswith("data:"):
            other = path.parent / unquote(image["uri"])
            require(other.is_file(), f"{other.name} is missing")
            by_start(other)


def fbx(path: Path) -> None:
    """A binary FBX file ends with a mark of its own."""
    with path.open("rb") as file:
        require(file.read(18) == b"Kaydara FBX Binary", "it does not begin like a binary .fbx")
    require(last(path, 16) == FBX_END, "its end is missing")


def usd(path: Path) -> None:
    """A USD file holds its table of contents, or as many closing as opening brackets."""
    with path.open("rb") as file:
        start = file.read(8)
        if start != b"PXR-USDC":
            require(start.startswith(b"#usda"), "it does not begin like a .usd")
            return _usda(path)
        file.seek(16)
        (table,) = take(file, "<q")
        size = path.stat().st_size
        require(0 < table < size, "its table of contents is missing")
        file.seek(table)
        (count,) = take(file, "<Q")
        require(count < 1000, "its table of contents is not whole")
        for _ in range(count):
            name, begin, length = take(file, "<16sqq")
            require(begin + length <= size, f"{name.rstrip(bytes(1)).decode()} is missing")
    return None


def _usda(path: Path) -> None:
    depth, quote = 0, ""
    text = path.read_text(encoding="utf-8", errors="replace")
    for mark in USDA_MARKS.findall(text):  # brackets count where nothing is quoted
        if quote:
            quote = "" if mark == quote else quote
        elif mark in ('"', "'", '"""', "'''", "@"):
            quote = mark
        else:
            depth += {"{": 1, "(": 1, "[": 1, "}": -1, ")": -1, "]": -1}.get(mark, 0)
    require(depth == 0 and not quote, "its brackets do not close")
    require(text.endswith("\n"), "its last line has no end")


def usdz(path: Path) -> None:
    """A .usdz is an archive; the first file in it is a USD file."""
    try:
        with zipfile.ZipFile(path) as archive:
            broken = archive.testzip()
            require(broken is None, f"{broken} in it is not whole")
            require(bool(archive.namelist()), "it is empty")
    except (zipfile.BadZipFile, struct.error) as error:
        raise Torn("it is no whole archive") from error


def abc(path: Path) -> None:
    """An Alembic file of the kind Ogawa has a mark that is set when it is done."""
    with path.open("rb") as file:
        magic, done, _, root = take(file, "<5sBHQ")
        size = path.stat().st_size
        require(magic == b"Ogawa", "it does not begin like an .abc")
        require(done == 0xFF, "its writing was not ended")
        require(root < size, "its root is missing")
        file.seek(root)
        (count,) = take(file, "<Q")
        file.seek(8 * count, 1)
        require(file.tell() <= size, "its root is cut off")


def dae(path: Path) -> None:
    """A Collada file is whole XML."""
    try:
        for _, node in ElementTree.iterparse(path):
            node.clear()
    except ElementTree.ParseError as error:
        raise Torn(str(error)) from error
