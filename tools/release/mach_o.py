"""What can be said of a macOS wheel without a Mac.

    python -m tools.release.mach_o WHEEL…

Fails unless each shared library is for the wheel's machine and for no newer macOS than the wheel
says, links to nothing but macOS's own libraries, and carries a signature whose hashes are right:
macOS on arm64 ends a program that loads a library without one.
"""

import hashlib
import struct
import sys
import tempfile
from pathlib import Path
from zipfile import ZipFile

from macholib.mach_o import (
    CPU_TYPE_NAMES,
    LC_BUILD_VERSION,
    LC_CODE_SIGNATURE,
    LC_LOAD_DYLIB,
    LC_VERSION_MIN_MACOSX,
)
from macholib.MachO import MachO

MACHINES = {"ARM64": "arm64", "x86_64": "x86_64"}
SUPER_BLOB, CODE_DIRECTORY, SHA256 = 0xFADE0CC0, 0xFADE0C02, 2


def main() -> None:
    """Print the facts of every wheel."""
    for name in sys.argv[1:]:
        wheel = Path(name)
        with ZipFile(wheel) as archive:
            libraries = [entry for entry in archive.namelist() if entry.endswith(".so")]
            assert libraries, f"{wheel.name} holds no shared library"
            for entry in libraries:
                print(f"{wheel.name}: {facts(archive.read(entry), wheel)}")


def facts(content: bytes, wheel: Path) -> str:
    """Return what a shared library needs, in a line; raises where it is not what it has to be."""
    with tempfile.NamedTemporaryFile() as file:
        file.write(content)
        file.flush()
        (header,) = MachO(file.name).headers
    _, major, minor, machine = wheel.stem.rsplit("-", 1)[1].split("_", 3)
    found = MACHINES[CPU_TYPE_NAMES[header.header.cputype]]
    assert found == machine, f"it is for {found}"

    linked, oldest, signature = [], None, None
    for command, details, data in header.commands:
        if command.cmd == LC_LOAD_DYLIB:
            linked.append(data.rstrip(b"\0").decode())
        elif command.cmd == LC_BUILD_VERSION:
            oldest = divmod(details.minos >> 8, 256)
        elif command.cmd == LC_VERSION_MIN_MACOSX:
            oldest = divmod(details.version >> 8, 256)
        elif command.cmd == LC_CODE_SIGNATURE:
            signature = content[details.dataoff :][: details.datasize]
    foreign = [path for path in linked if not path.startswith(("/usr/lib/", "/System/"))]
    assert not foreign, f"it links to {', '.join(foreign)}"
    assert oldest is not None, "it does not say which macOS it is for"
    assert oldest <= (int(major), int(minor)), f"it is for macOS {oldest[0]}.{oldest[1]} and later"
    pages = "no signature" if signature is None else f"{check_signature(signature, content)} pages"
    assert signature is not None or machine != "arm64", "it is not signed"
    names = ", ".join(sorted(Path(path).name for path in linked))
    return f"{machine}, macOS {oldest[0]}.{oldest[1]}, links to {names}; signature: {pages}"


def check_signature(signature: bytes, content: bytes) -> int:
    """Check the hash of every page that a signature covers; return how many there are."""
    magic, _, count = struct.unpack_from(">3I", signature)
    assert magic == SUPER_BLOB, "its signature is not one"
    blobs = [struct.unpack_from(">2I", signature, 12 + 8 * i)[1] for i in range(count)]
    (start,) = (at for at in blobs if struct.unpack_from(">I", signature, at)[0] == CODE_DIRECTORY)
    hashes, _, _, pages, limit = struct.unpack_from(">5I", signature, start + 16)
    size, kind, _, shift = struct.unpack_from("4B", signature, start + 36)
    assert kind == SHA256, "its signature is not of SHA-256"
    for page in range(pages):
        covered = content[page << shift : min((page + 1) << shift, limit)]
        expected = signature[start + hashes + page * size :][:size]
        assert hashlib.sha256(covered).digest() == expected, f"page {page} is not as it was signed"
    return pages


if __name__ == "__main__":
    main()
