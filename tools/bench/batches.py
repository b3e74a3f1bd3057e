"""How much faster two processes do many files, and what handing a file to a process takes."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import trimesh

from .meshes import bumpy_sphere
from .page import Page

FREQUENCIES = (8,)  # of a sphere with 642 vertices
FILES = 100
ENGINES = {
    "one process": (1, ["--jobs", "1"]),
    "two processes": (2, ["--jobs", "2"]),
    "Dask, one worker": (1, ["--scheduler", "local"]),
    "Dask, two workers": (2, ["--scheduler", "local"]),
}
# Has a program use one core.
ONE_CORE = ("taskset", "-c", "0")
PROGRAM = (sys.executable, "-m", "spectral_tv.cli")
# Does the files one after the other in one process, without handing them out.
HERE = """
import sys
from spectral_tv.cli.verbs import VERBS
from spectral_tv.command_line import program
sys.exit(program.run("spectral-tv", VERBS, sys.argv[1:], None))
"""


def report(page: Page, frequencies: tuple[int, ...] = FREQUENCIES, files: int = FILES) -> None:
    """Print the table."""
    with page.table(
        "batches",
        f"{files} files of {', '.join(str(10 * n * n + 2) for n in frequencies)} vertices, on "
        "one core and on two; the start of the processes is taken off, as a run of two files "
        "tells it; the overhead is what a file takes on one core beyond the work itself",
        "vertices | engine | files a second | times one process | overhead of a file",
    ) as row:
        for frequency in frequencies:
            vertices, triangles = bumpy_sphere(frequency)
            with tempfile.TemporaryDirectory() as folder:
                place = Path(folder)
                shape = trimesh.Trimesh(vertices, triangles, process=False)
                for count in (2, files):
                    (place / str(count)).mkdir()
                    for number in range(count):
                        shape.export(place / str(count) / f"{number:04d}.ply")
                plain = seconds(place, files, [*ONE_CORE, sys.executable, "-c", HERE], [])
                first = 0.0
                for engine, (cores, options) in ENGINES.items():
                    program = [*(ONE_CORE if cores == 1 else ()), *PROGRAM]
                    found = seconds(place, files, program, options)
                    first = first or found
                    overhead = f"{1e3 * (found - plain) / (files - 2):.0f} ms"
                    row(
                        len(vertices), engine, f"{(files - 2) / found:.1f}",
                        f"{first / found:.2f}", overhead if cores == 1 else "–",
                    )  # fmt: skip


def seconds(place: Path, files: int, program: list[str], options: list[str]) -> float:
    """The time for all files but two."""
    return timed(place, files, program, options) - timed(place, 2, program, options)


def timed(place: Path, count: int, program: list[str], options: list[str]) -> float:
    """The time for so many files."""
    out = place / "out"
    out.mkdir(exist_ok=True)
    command = [*program, "decompose", place / str(count), "-o", out, "--format", "npz", *options]
    started = time.perf_counter()
    subprocess.run(list(map(str, command)), check=True, capture_output=True)
    return time.perf_counter() - started
