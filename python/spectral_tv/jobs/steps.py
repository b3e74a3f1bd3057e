"""Jobs one after the other, each made of what the one before gave; polled like one job."""

from collections.abc import Callable, Generator, Sequence
from typing import Any, Generic, TypeVar, cast

import spectral_tv
from spectral_tv.jobs.together import Together
from spectral_tv.refusal import Refusal

T = TypeVar("T")

# A job, and the fraction of all the work that is done when it ends.
Step = tuple["Work", float]


def in_turn(
    starts: Sequence[Callable[[], Any]], until: float = 1.0
) -> Generator[Step, Any, list[Any]]:
    """Run what each of ``starts`` starts, and return all results.

    They take alike parts of the work; ``until`` is the part that is done by then.
    """
    results = []
    for number, start in enumerate(starts, 1):
        results.append((yield start(), until * number / len(starts)))
    return results


class Steps(Generic[T]):
    """Runs the jobs that a generator yields, and sends it their results; what it returns is the
    result."""

    def __init__(self, steps: Generator[Step, Any, T]) -> None:
        """Start the first job."""
        self._steps = steps
        self._before = 0.0
        self._is_over = self._is_cancelled = False
        self._result: T | None = None
        self._error: Exception | None = None
        self._job, self._after = next(steps)

    @property
    def progress(self) -> float:
        """The fraction of the work done, in [0, 1]."""
        if self._is_over:
            return 1.0
        return self._before + (self._after - self._before) * self._job.progress

    @property
    def done(self) -> bool:
        """Whether all have ended, or one has failed; starts the next one."""
        if not self._is_over and not self._job.done:
            return False
        if self._is_over or self._is_cancelled:
            return True
        try:
            found = self._job.result()
        except (spectral_tv.MeshError, spectral_tv.Cancelled, RuntimeError, MemoryError):
            return True  # whoever asks for the result learns why
        self._before = self._after
        try:
            self._job, self._after = self._steps.send(found)
        except StopIteration as end:
            self._result, self._is_over = end.value, True
        except (spectral_tv.MeshError, Refusal, MemoryError) as error:
            self._error, self._is_over = error, True
        return self._is_over

    def cancel(self) -> None:
        """Ask the one that runs to stop; no other is started."""
        self._is_cancelled = True
        self._job.cancel()

    def result(self, progress: Callable[[float], None] | None = None) -> T:
        """Wait, and return the result; raises what the job that failed raised, or the generator.

        ``progress`` takes the fraction done.
        """
        told = None if progress is None else lambda _fraction: progress(self.progress)
        while not self.done:
            self._job.result(told)
        if self._error is not None:
            raise self._error
        if not self._is_over:
            self._job.result()
            raise spectral_tv.Cancelled("cancelled")
        return cast(T, self._result)


# What may run.
Work = spectral_tv.Job[Any] | Together | Steps[Any]
