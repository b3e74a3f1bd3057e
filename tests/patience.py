"""Results of jobs, for tests in which work may go astray."""

from __future__ import annotations

import time
from typing import Any

import spectral_tv

# Far beyond what any of the small meshes takes on a busy machine.
PATIENCE = 120.0


def result(job: spectral_tv.Job[Any]) -> Any:
    """What the job gives or raises; a job that hangs is ended and fails the test."""
    end = time.monotonic() + PATIENCE
    while not job.done:
        if time.monotonic() > end:
            job.cancel()
            raise AssertionError(f"the job hangs at {job.progress:.0%}")
        time.sleep(2e-4)
    return job.result()
