"""How near `estimate` comes to the time that a decomposition takes."""

from __future__ import annotations

import time

import spectral_tv

from .meshes import bumpy_sphere
from .page import Page

# What is decomposed, and how.
WORKS = (
    ("m1", {}), ("m2", {}), ("m3", {}), ("m1", {"scheme": "lagged"}), ("m1", {"scheme": "exact"}),
)  # fmt: skip


def report(page: Page, frequencies: tuple[int, ...]) -> None:
    """Print the table."""
    with page.table(
        "estimates",
        "The estimated time over the time that was taken, once; default steps on bumpy spheres, by "
        "all processors and by one thread",
        "vertices | M1 | M2 | M3 | M1, lagged | M1, exact | M1, one thread | M3, one thread",
    ) as row:
        for frequency in frequencies:
            mesh = spectral_tv.Mesh(*bumpy_sphere(frequency))
            ratios = [_ratio(mesh, method, **settings) for method, settings in WORKS]
            with spectral_tv.use_threads(1):
                ratios += [_ratio(mesh, method) for method in ("m1", "m3")]
            row(len(mesh.vertices), *(f"{ratio:.2f}" for ratio in ratios))


def _ratio(mesh: spectral_tv.Mesh, method: str, **settings: str) -> float:
    estimated = spectral_tv.estimate(mesh, method, **settings).seconds
    started = time.perf_counter()
    spectral_tv.decompose(mesh, method, **settings)
    return estimated / (time.perf_counter() - started)
