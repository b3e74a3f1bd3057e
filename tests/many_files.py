"""Files for the tests of batches: good ones, broken ones, one that never ends, and a huge one."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path

import meshio
import numpy as np
import psutil
import trimesh
from shapes import bumpy_sphere

COMMAND = (sys.executable, "-m", "spectral_tv.cli", "decompose")
QUICK = ("--steps", "8", "--bands", "3", "--keep-limbs", "0")
HALF = ".spectral_tv_"
SERVE = "serve-a-batch"
BROKEN = {
    "torn.stl": b"solid nothing",
    "cut.ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 100\n",
    "empty.obj": b"",
    "points.off": b"OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n",
    "numbers.obj": b"v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n",
}


def write_good(folder: Path, count: int) -> list[Path]:
    """Write small meshes, half of them one folder deeper."""
    vertices, triangles = bumpy_sphere(2)
    (folder / "deep").mkdir(parents=True, exist_ok=True)
    found = []
    for number in range(count):
        path = folder / ("deep" if number % 2 else "") / f"mesh_{number:03d}.ply"
        noise = np.random.default_rng(number).normal(0, 0.01, vertices.shape)
        trimesh.Trimesh(vertices + noise, triangles, process=False).export(path)
        found.append(path)
    return found


def write_broken(folder: Path) -> list[Path]:
    """Write files that hold no mesh, or half of one."""
    for name, content in BROKEN.items():
        (folder / name).write_bytes(content)
    return [folder / name for name in BROKEN]


def write_endless(path: Path, size: int = 560) -> Path:
    """Write a mesh that takes many seconds."""
    x, y = np.meshgrid(np.arange(size), np.arange(size), indexing="ij")
    z = np.random.default_rng(0).normal(size=x.shape)
    corners = (x * size + y)[:-1, :-1].ravel()
    triangles = np.concatenate(
        [
            np.stack([corners, corners + size, corners + 1], 1),
            np.stack([corners + 1, corners + size, corners + size + 1], 1),
        ]
    ).astype(np.int32)
    points = np.stack([x, y, z], -1).reshape(-1, 3).astype(float)
    meshio.Mesh(points, [("triangle", triangles)]).write(path)
    return path


def write_huge(path: Path) -> Path:
    """Write a VTK file that announces a billion points."""
    head = "# vtk DataFile Version 3.0\nhuge\nASCII\nDATASET UNSTRUCTURED_GRID\n"
    path.write_text(f"{head}POINTS 1000000000 double\n0 0 0\n")
    return path


def start(*arguments: object, prefix=(), **more) -> subprocess.Popen[str]:
    """Start the program, by another if there is a ``prefix``."""
    command = [*prefix, *COMMAND, *map(str, arguments)]
    return subprocess.Popen(command, stderr=subprocess.PIPE, text=True, **more)


def lines_of(report: Path) -> list[dict]:
    """What a report has so far."""
    if not report.exists():
        return []
    return [json.loads(line) for line in report.read_text().splitlines()]


def wait_for(condition, seconds: float = 120):
    """Wait until it holds, and return what it gave."""
    end = time.monotonic() + seconds
    while not (found := condition()):
        assert time.monotonic() < end
        time.sleep(0.02)
    return found


def serving(process: subprocess.Popen[str] | psutil.Process) -> list[psutil.Process]:
    """The processes, beneath one, that do tasks."""
    found = []
    for each in psutil.Process(process.pid).children(recursive=True):
        try:
            if SERVE in each.cmdline():
                found.append(each)
        except psutil.NoSuchProcess:
            continue
    return found


def written_in(folder: Path) -> list[Path]:
    """Files that are whole."""
    files = [path for path in folder.rglob("*") if path.is_file()]
    return [path for path in files if not any(part.startswith(HALF) for part in path.parts)]


def left_behind(folder: Path) -> list[Path]:
    """Files that are half written."""
    return [path for path in folder.rglob("*") if path.name.startswith(HALF)]
