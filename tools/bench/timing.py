"""Times of computations that run in turn, so that other load slows all of them alike."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

RUNS = 3


def interleaved(*works: Callable[[], object], runs: int = RUNS) -> list[float]:
    """Median seconds of each work, all run in turn `runs` times.

    A work that returns a float has measured itself.
    """
    seconds = [[] for _ in works]
    for _ in range(runs):
        for work, record in zip(works, seconds, strict=True):
            record.append(timed(work))
    return [float(np.median(record)) for record in seconds]


def timed(work: Callable[[], object]) -> float:
    """Seconds that a work takes."""
    started = time.perf_counter()
    measured = work()
    return measured if isinstance(measured, float) else time.perf_counter() - started


def rate(seconds: float) -> str:
    """How often a second a work is done, as text."""
    return f"{1 / seconds:.0f}" if seconds < 0.1 else f"{1 / seconds:.1f}"
