"""How long a job goes on once it is cancelled."""

from __future__ import annotations

import contextlib
import time

import spectral_tv

from .meshes import Shape
from .page import Page

MOMENTS = 12


def report(page: Page, shapes: list[tuple[str, Shape]]) -> None:
    """Print the table."""
    with page.table(
        "interruption",
        f"The time from `cancel()` until the job has ended: the longest of {MOMENTS} moments, "
        "spread over the whole run",
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
    return max(delay(mesh, method, whole * k / MOMENTS) for k in range(MOMENTS))


def delay(mesh: spectral_tv.Mesh, method: str, moment: float) -> float:
    """Seconds from cancelling a job after `moment` seconds until it has ended."""
    job = spectral_tv.start_decompose(mesh, method)
    time.sleep(moment)
    cancelled = time.perf_counter()
    job.cancel()
    with contextlib.suppress(spectral_tv.Cancelled):
        job.result()
    return time.perf_counter() - cancelled
