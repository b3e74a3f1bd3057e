"""Write the licences of all that is built into the wheels, besides our own.

python -m tools.release.notices FILE CARGO_ABOUT

Each text is a file of what is built in: of the crates, of Rust's standard library as the release's
compiler has it, of Zig and Debian's MinGW-w64, which link their own runtimes. Needs Debian 12.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FETCHED = ROOT / ".build" / "notices"
PART, BLOCK, TEXT = "#" * 80, "=" * 80, "-" * 80
CRATES = """\
What is built into the wheels and zips of Spectral TV, besides its own sources, is in three parts:
crates; the standard library of Rust; the runtimes of the compilers that link. Some of it is for
some systems only. Where a crate has no copy of its licence that can be told from others, the text
is that of SPDX, and the authors are those whom the crate names.

Made by `make notices`.
"""
STANDARD = "The standard library of Rust, and the crates that it is built from."
RUNTIMES = "The runtimes that Zig and MinGW-w64 link."
# What Zig links, on which systems, and where its licence is in the package ziglang.
ZIG = (
    ("compiler_rt, of Zig", "Linux, macOS, Windows on arm64", "LICENSE"),
    ("libunwind, of LLVM", "Linux, Windows on arm64", "lib/libunwind/LICENSE.TXT"),
    ("Start files of glibc", "Linux", "lib/libc/glibc/LICENSES"),
    ("Start files and libraries of MinGW-w64", "Windows on arm64", "lib/libc/mingw/COPYING"),
    ("Functions of musl", "Windows on arm64", "lib/libc/musl/COPYRIGHT"),
)
# Of Debian: the package, what is built in of it, and where in its list of licences that begins and
# ends.
DEBIAN = (
    ("mingw-w64-common", "Start files and libraries of MinGW-w64", "", ""),
    ("gcc-mingw-w64-base", "libgcc, of GCC", "GCC is Copyright (C)", "The libbacktrace library"),
    (
        "gcc-mingw-w64-base",
        "libgcc, of GCC: the exception",
        "GCC RUNTIME LIBRARY EXCEPTION\n",
        "libquadmath/",
    ),
)
STANDARD_SOURCES = "rust-web-src"
# Where Debian's list of licences of Rust tells of the standard library, from one mark to another.
OF_OTHERS = "Files: library/", "Files: src/"
UNICODE = "License: Unicode-Data-Files-and-Software-License\n ", "\n\nLicense:"


def main(output: Path, about: Path) -> None:
    """Write the three parts."""
    FETCHED.mkdir(parents=True, exist_ok=True)
    fetch_from_debian({STANDARD_SOURCES, *(package for package, *_ in DEBIAN)})
    parts = [
        CRATES + licences(about, ROOT / "rust" / "about.toml", ROOT / "rust" / "python"),
        f"{STANDARD}\n{standard_library(about)}",
        f"{RUNTIMES}\n{''.join(runtimes())}",
    ]
    text = f"{PART}\n".join(part.rstrip() + "\n\n" for part in parts).rstrip() + "\n"
    output.write_text(text, encoding="utf-8")


def licences(
    about: Path, config: Path, crate: Path, features: Sequence[str] = (), **environment: str
) -> str:
    """What cargo-about finds of a crate's dependencies: offline, so that it is always the same."""
    manifest = crate / "Cargo.toml"
    settings = {**os.environ, **environment}
    fetch = ["cargo", "fetch", "--locked", "--quiet", "--manifest-path", str(manifest)]
    subprocess.run(fetch, check=True, env=settings)
    command = [str(about.resolve()), "generate", "--config", str(config), "--manifest-path"]
    options = ["--locked", "--offline", "--fail", *features, str(ROOT / "rust" / "about.hbs")]
    run = subprocess.run(
        [*command, str(manifest), *options],
        check=True, capture_output=True, text=True, env=settings,
    )  # fmt: skip
    return run.stdout


def standard_library(about: Path) -> str:
    """Rust's own notices, and the licences of its crates."""
    sources = next((FETCHED / "root" / "usr" / "src").glob("rustc-*"))
    listed = FETCHED / "root" / "usr" / "share" / "doc" / STANDARD_SOURCES / "copyright"
    config = ROOT / "rust" / "about_standard.toml"
    library = sources / "library" / "std"
    features = ["--features", "backtrace panic-unwind"]
    return "".join(
        [
            block("Rust", ["std and its parts"], sources / "COPYRIGHT"),
            block("Rust: copyright of some files", ["std and its parts"], listed, *OF_OTHERS),
            block("Rust: tables of Unicode", ["core"], listed, *UNICODE),
            # Its manifests use what Cargo has for Rust itself alone.
            licences(about, config, library, features, RUSTC_BOOTSTRAP="1"),
        ]
    )


def runtimes() -> Iterator[str]:
    """Each runtime with the text of its licence."""
    zig = zig_package()
    for name, systems, file in ZIG:
        yield block(name, [f"by Zig, on {systems}"], zig / file)
    for package, name, start, end in DEBIAN:
        listed = FETCHED / "root" / "usr" / "share" / "doc" / package / "copyright"
        yield block(name, ["by Debian's MinGW-w64, on Windows on x86-64"], listed, start, end)


def block(title: str, used: list[str], file: Path, start: str = "", end: str = "") -> str:
    """A text of a file, or its part from a mark to another, under its title."""
    text = file.read_text(encoding="utf-8")
    if start not in text or end not in text:
        sys.exit(f"notices.py: {file} has no '{start}' or '{end}'")
    begin = text.index(start)
    text = text[begin : text.index(end, begin) if end else None].strip("\n")
    lines = "".join(f"- {each}\n" for each in used)
    return f"{BLOCK}\n{title}\n\n{lines}{TEXT}\n{text}\n\n"


def zig_package() -> Path:
    """The package ziglang as the release's compiler has it."""
    groups = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    wanted = next(
        each for each in groups["dependency-groups"]["release"] if each.startswith("ziglang==")
    )
    place = FETCHED / wanted
    if not place.exists():
        pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target"]
        subprocess.run([*pip, str(place), wanted], check=True)
    return place / "ziglang"


def fetch_from_debian(packages: set[str]) -> None:
    """Unpack the newest of some packages, unless they are there."""
    if shutil.which("apt-get") is None:
        sys.exit("notices.py: needs Debian's apt-get")
    policy = ["apt-cache", "show", "--no-all-versions", *sorted(packages)]
    shown = subprocess.run(policy, check=True, capture_output=True, text=True).stdout
    newest = "\n".join(line for line in shown.splitlines() if line.startswith("SHA256:"))
    stamp = FETCHED / "newest"
    if stamp.exists() and stamp.read_text(encoding="utf-8") == newest:
        return
    shutil.rmtree(FETCHED / "root", ignore_errors=True)
    for old in FETCHED.glob("*.deb"):
        old.unlink()
    download = ["apt-get", "--quiet", "--quiet", "download", *sorted(packages)]
    subprocess.run(download, check=True, cwd=FETCHED)
    for file in FETCHED.glob("*.deb"):
        subprocess.run(["dpkg-deb", "--extract", str(file), str(FETCHED / "root")], check=True)
    stamp.write_text(newest, encoding="utf-8")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
