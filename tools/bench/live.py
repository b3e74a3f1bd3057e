"""How fast *Live* follows a handle in Blender: ``python -m tools.bench.live [MESH…]``."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from .meshes import Shape, pinched_sphere, read
from .page import Page
from .timing import rate
from .turn import DEGREES

ALGORITHMS = {"POSE": "Pose", "CONVEX": "Total Variation"}
FRAMES = 30
FREQUENCIES = (26, 66)


def main() -> None:
    """Print the table, of generated meshes unless there are some of one's own."""
    shapes = [(path.stem, read(path)) for path in map(Path, sys.argv[1:])]
    report(Page(None), shapes or [("pinched sphere", pinched_sphere(n)) for n in FREQUENCIES])


def report(page: Page, shapes: list[tuple[str, Shape]]) -> None:
    """Print the table; a process for each row."""
    with page.table(
        "live",
        f"Live while a handle is turned by {DEGREES}° in {FRAMES} updates, and until it has "
        "settled; memory is the most of the process, until Live was started and in all",
        "mesh | vertices | algorithm | reading | updates a second | slowest | from its end | "
        "further updates | settling | memory before | in all",
    ) as row:
        for name, shape in shapes:
            for algorithm, label in ALGORITHMS.items():
                found = measured(shape, algorithm)
                row(
                    name, len(shape[0]), label, f"{1e3 * found['reading']:.0f} ms",
                    rate(found["mean"]), f"{1e3 * found['slowest']:.0f} ms",
                    f"{found['lag']:.1%}", found["rough"], f"{found['settling']:.2f} s",
                    f"{found['before']:.0f} MB", f"{found['most']:.0f} MB",
                )  # fmt: skip


def measured(shape: Shape, algorithm: str) -> dict[str, float]:
    """Measure one mesh and algorithm in a new process: seconds, MB, a share of the diagonal."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mesh.npz"
        np.savez(path, vertices=shape[0], triangles=shape[1])
        work = [str(path), algorithm, str(FRAMES)]
        command = [sys.executable, "-m", "tools.bench.live_process", *work]
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


if __name__ == "__main__":
    main()
