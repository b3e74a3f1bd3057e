"""How time and memory grow with the number of vertices.

python -m tools.bench.growth VERTICES METHOD SOLVER measures one size in a process of its own.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import time

import numpy as np
import spectral_tv

SIZES = (10_000, 40_000, 160_000, 640_000, 1_000_000)
STEPS = 30


def report() -> None:
    """Print the table."""
    print(f"\n{STEPS} default steps on bumpy tori, seconds; the peak memory of the process, NumPy")
    print("and the arrays included, in MB; and M1's by factorization alone")
    print("| vertices | M1 | M2 | M3 | M1, memory | M1, Cholesky | its memory |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for size in SIZES:
        runs = [measured(size, method, "auto") for method in ("m1", "m2", "m3")]
        factorized = measured(size, "m1", "cholesky")
        print(
            f"| {size} | " + " | ".join(f"{run['seconds']:.2f}" for run in runs)
            + f" | {runs[0]['megabytes']:.0f} | {factorized['seconds']:.2f} "
            f"| {factorized['megabytes']:.0f} |",
            flush=True,
        )  # fmt: skip


def measured(size: int, method: str, solver: str) -> dict[str, float]:
    """Run this module for one size."""
    command = [sys.executable, "-m", "tools.bench.growth", str(size), method, solver]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def bumpy_torus(size: int) -> tuple[np.ndarray, np.ndarray]:
    """About `size` vertices (V, 3), and triangles (F, 3)."""
    minor = round(np.sqrt(size / 2))
    major = 2 * minor
    around, tube = np.meshgrid(np.arange(major), np.arange(minor), indexing="ij")
    u, v = 2 * np.pi * around / major, 2 * np.pi * tube / minor
    waves = sum(np.sin(k * u) * np.cos((k // 2 + 1) * v) / k for k in (5, 11, 23, 47))
    radius = 0.5 * (1 + 0.2 * waves)
    distance = 1.2 + radius * np.cos(v)
    shape = [distance * np.cos(u), distance * np.sin(u), radius * np.sin(v)]
    index = around * minor + tube
    right, up = np.roll(index, -1, axis=0), np.roll(index, -1, axis=1)
    corner = np.roll(right, -1, axis=1)
    triangles = np.concatenate(
        [np.stack([index, right, corner], axis=-1), np.stack([index, corner, up], axis=-1)]
    )
    return np.stack(shape, axis=-1).reshape(-1, 3), triangles.reshape(-1, 3)


def main() -> None:
    """Measure one size."""
    size, method, solver = sys.argv[1:]
    mesh = spectral_tv.Mesh(*bumpy_torus(int(size)))
    started = time.perf_counter()
    spectral_tv.decompose(mesh, method, steps=STEPS, solver=solver)
    seconds = time.perf_counter() - started
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(json.dumps({"seconds": seconds, "megabytes": peak}))


if __name__ == "__main__":
    main()
