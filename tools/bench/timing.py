"""Times of works that are run in turn, so that they share whatever else the machine does."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

RUNS = 3


def interleaved(*works: Callable[[], None], runs: int = RUNS) -> list[float]:
    """Median seconds of each work, all run in turn `runs` times."""
    seconds = [[] for _ in works]
    for _ in range(runs):
        for work, record in zip(works, seconds, strict=True):
            started = time.perf_counter()
            work()
            record.append(time.perf_counter() - started)
    return [float(np.median(record)) for record in seconds]
