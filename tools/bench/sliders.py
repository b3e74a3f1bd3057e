"""How long Blender takes to show another value of a band: ``python -m tools.bench.sliders``.

BLENDER, a command line, names a program that is measured beside pip's ``bpy``.
"""

from __future__ import annotations

import json
import os
import shlex
import subprocess
import sys
import tempfile
from itertools import product
from pathlib import Path

import numpy as np

from .meshes import Shape, bumpy_sphere, read
from .page import Page

BANDS = 5
KINDS = {"KEYS": "shape keys", "ATTRIBUTES": "attributes"}
FREQUENCIES = (66, 222, 316)
PROCESS = Path(__file__).with_name("sliders_process.py")


def main() -> None:
    """Print the table, of generated meshes unless there are some of one's own."""
    shapes = [(path.stem, read(path)) for path in map(Path, sys.argv[1:])]
    report(Page(None), shapes or [("bumpy sphere", bumpy_sphere(n)) for n in FREQUENCIES])


def report(page: Page, shapes: list[tuple[str, Shape]]) -> None:
    """Print the table; a process for each mesh and Blender."""
    with page.table(
        "sliders",
        f"From another value of one of {BANDS} bands of M1 until Blender has evaluated the mesh, "
        "alone and with the extension, its open panels drawn; then Blender's normals; medians",
        "mesh | vertices | Blender | bands as | not at 0 | Blender alone | with the extension | "
        "ratio | and normals of faces | and of vertices",
    ) as row:
        for name, shape in shapes:
            for program, kind in product(programs(), KINDS):
                for found in measured(shape, program, kind):
                    times = [found[each] for each in ("alone", "with", "faces", "vertices")]
                    alone, both, faces, vertices = (f"{1e3 * each:.0f} ms" for each in times)
                    row(
                        name, len(shape[0]), found["version"], KINDS[kind], found["acting"],
                        alone, both, f"{found['with'] / found['alone']:.2f}", faces, vertices,
                    )  # fmt: skip


def programs() -> list[list[str]]:
    """The command lines that run a script: of pip's bpy, and of the program that BLENDER names."""
    named = shlex.split(os.environ.get("BLENDER", ""))
    options = ["--background", "--factory-startup", "--python-exit-code", "7", "--python"]
    return [[sys.executable], *([[*named, *options]] if named else [])]


def measured(shape: Shape, program: list[str], kind: str) -> list[dict]:
    """Measure one mesh in a new process, with one band and with all bands not at 0; in seconds."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mesh.npz"
        np.savez(path, vertices=shape[0], triangles=shape[1])
        command = [*program, str(PROCESS), "--", str(path), str(BANDS), kind]
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
    return [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]


if __name__ == "__main__":
    main()
