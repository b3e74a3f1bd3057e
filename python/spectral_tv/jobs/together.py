"""Jobs at the same time; polled like one job."""

from collections.abc import Callable
from typing import Any

import spectral_tv


class Together:
    """Jobs that run at the same time, the first of which makes the result.

    They take the processors that one alone would leave idle.
    """

    def __init__(self, *jobs: spectral_tv.Job[Any]) -> None:
        """Take jobs that have been started."""
        self._jobs = jobs

    @property
    def progress(self) -> float:
        """The fraction of the work done, in [0, 1]: that of the job that is least far."""
        return min(job.progress for job in self._jobs)

    @property
    def done(self) -> bool:
        """Whether all have ended."""
        return all(job.done for job in self._jobs)

    def cancel(self) -> None:
        """Ask all to stop."""
        for job in self._jobs:
            job.cancel()

    def result(self, progress: Callable[[float], None] | None = None) -> Any:
        """Wait for all, and return the result of the first; raises what one that failed raised.

        ``progress`` takes the fraction done.
        """
        told = None if progress is None else lambda _fraction: progress(self.progress)
        results = [job.result(told) for job in self._jobs]
        return results[0]
