"""The machine, and the versions of programs, that the measurements were made with."""

from __future__ import annotations

import os
import platform
import subprocess
from importlib.metadata import version
from pathlib import Path

from .page import Page

PACKAGES = ("spectral-tv", "numpy", "scipy", "scikit-sparse", "pypardiso", "libigl", "bpy")
LIBRARIES = ("libsuitesparse-dev", "libopenblas0-pthread", "libblas3", "libmetis5")


def report(page: Page) -> None:
    """Print the table."""
    with page.table("machine", "The machine and the versions", "what | which") as row:
        row("processor", f"{processor()}, {os.cpu_count()} in all")
        row("memory", f"{os.sysconf('SC_PAGE_SIZE') * os.sysconf('SC_PHYS_PAGES') / 2**30:.0f} GiB")
        row("system", f"{system()}, Linux {platform.release()}")
        row("Rust", told("rustc", "--version"))
        row("Python", platform.python_version())
        row("packages", ", ".join(f"{name} {version(name)}" for name in PACKAGES))
        row("Debian's", ", ".join(filter(None, map(debian_version, LIBRARIES))))


def processor() -> str:
    """The name of the processor."""
    lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.machine())


def system() -> str:
    """The name of the distribution."""
    return platform.freedesktop_os_release().get("PRETTY_NAME", "Linux")


def debian_version(package: str) -> str:
    """Name and version of a Debian package, or nothing."""
    command = ["dpkg-query", "--show", "--showformat=${Package} ${Version}", package]
    return told(*command)


def told(*command: str) -> str:
    """What a command prints; nothing if it fails."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""
