"""Measure the library against what one would write in SciPy, and libigl, as ratios in one run.

python -m tools.bench [MESH.ply ...]
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

import numpy as np
import spectral_tv

from . import deformation, eigenpairs, exact, growth
from .cholmod import lagged_m1
from .meshes import bumpy_sphere, pinched_sphere, read_ply
from .timing import RUNS, interleaved

STEPS = 30


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(prog="make bench", description=__doc__)
    parser.add_argument("meshes", type=Path, nargs="*", help="binary .ply files of triangles")
    paths = parser.parse_args().meshes
    shapes = [(path.stem, *read_ply(path)) for path in paths] or [
        (f"bumpy sphere {subdivisions}", *bumpy_sphere(subdivisions)) for subdivisions in (5, 6)
    ]
    print(f"{STEPS} steps of M1 on the same times, the median of {RUNS} interleaved runs")
    print("| mesh | vertices | SciPy + CHOLMOD | lagged | ratio | default | ratio | difference |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for name, vertices, triangles in shapes:
        print(row(name, vertices, triangles), flush=True)
    deformation.report(
        shapes
        if paths
        else [
            shapes[0],
            *((f"pinched sphere {size}", *pinched_sphere(size)) for size in (5, 6)),
        ]
    )
    exact.report()
    eigenpairs.report(*(shapes[0]))
    growth.report()


def row(name: str, vertices: np.ndarray, triangles: np.ndarray) -> str:
    """Measure one mesh; the difference is of the two lagged flows, relative to the size."""
    mesh = spectral_tv.Mesh(vertices, triangles)
    times = np.append(0, np.geomspace(2e-5, 2e-2, STEPS) * mesh.area)
    states = {}

    def ours(scheme: str) -> Callable[[], None]:
        def run() -> None:
            fresh = spectral_tv.Mesh(vertices, triangles)
            states[scheme] = spectral_tv.decompose(fresh, "m1", times=times, scheme=scheme)

        return run

    def theirs() -> None:
        states["cholmod"] = lagged_m1(vertices, triangles, times)

    cholmod, lagged, default = interleaved(theirs, ours("lagged"), ours("extrapolated"))
    difference = np.abs(states["lagged"].flow.states - states["cholmod"]).max()
    relative = difference / np.ptp(vertices, axis=0).max()
    return (
        f"| {name} | {len(vertices)} | {cholmod:.2f} s | {lagged:.2f} s | {cholmod / lagged:.1f} "
        f"| {default:.2f} s | {cholmod / default:.1f} | {relative:.0e} |"
    )


if __name__ == "__main__":
    main()
