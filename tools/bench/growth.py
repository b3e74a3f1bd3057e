"""How time and memory grow with the number of vertices."""

from __future__ import annotations

from .meshes import bumpy_torus
from .page import Page
from .process import Bench, Work

STEPS = 30


def report(page: Page, sizes: tuple[int, ...]) -> None:
    """Print the table."""
    with page.table(
        "growth",
        f"{STEPS} default steps on bumpy tori, once; the peak memory of the process, NumPy and the "
        "arrays included",
        "vertices | M1 | M2 | M3 | M1, µs a vertex | M1, memory | M1 by Cholesky | its memory",
    ) as row:
        for size in sizes:
            shape = bumpy_torus(size)
            bench = Bench(shape)
            auto, m2, m3, factorized = (
                bench.run(Work("spectral_tv", method, "extrapolated", solver, STEPS))
                for method, solver in (
                    ("m1", "auto"), ("m2", "auto"), ("m3", "auto"), ("m1", "cholesky")
                )
            )  # fmt: skip
            row(
                len(shape[0]), *(f"{run.seconds:.2f} s" for run in (auto, m2, m3)),
                f"{1e6 * auto.seconds / len(shape[0]):.1f}", f"{auto.megabytes:.0f} MB",
                f"{factorized.seconds:.2f} s", f"{factorized.megabytes:.0f} MB",
            )  # fmt: skip
