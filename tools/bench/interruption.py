"""How long a job goes on once it is cancelled."""

from __future__ import annotations

import time

import spectral_tv

from .meshes import Shape
from .page import Page

MOMENTS = 24


def report(page: Page, shapes: list[tuple[str, Shape]]) -> None:
    """Print the table."""
    with page.table(
        "interruption",
        f"The time from `cancel()` until the job has ended: the longest of {MOMENTS} moments, "
        "every other in its first second, where a flow is prepared",
        "mesh | vertices | M1 | M2 | M3",
    ) as row:
        for name, shape in shapes:
            mesh = spectral_tv.Mesh(*shape)
            delays = (longest(mesh, method) for method in ("m1", "m2", "m3"))
            row(name, len(shape[0]), *(f"{1e3 * seconds:.0f} ms" for seconds in delays))


def longest(mesh: spectral_tv.Mesh, method: str) -> float:
    """Seconds, the most of all moments."""
    started = time.perf_counter()
    spectral_tv.decompose(mesh, method)
    whole = time.perf_counter() - started
    ends = (whole, min(1.0, whole))
    return max(delay(mesh, method, ends[k % 2] * k / MOMENTS) for k in range(MOMENTS))


def delay(mesh: spectral_tv.Mesh, method: str, moment: float) -> float:
    """Seconds from cancelling a job after `moment` seconds until it has ended."""
    job = spectral_tv.start_decompose(mesh, method)
    time.sleep(moment)
    cancelled = time.perf_counter()
    job.cancel()
    while not job.done:
        time.sleep(0.001)
    return time.perf_counter() - cancelled
