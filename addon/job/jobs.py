"""The one job that may run: work in a native thread, on copies, that never touches Blender."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import bpy
import spectral_tv

from ..scene.contents import digest, topology_digest
from ..scene.coordinates import basis_coordinates


class Chain:
    """Jobs one after the other, and a last one of all their results; polled like one job.

    Without a last one the results themselves are the result.
    """

    # Of the whole, what the last one takes.
    LAST = 0.05

    def __init__(
        self,
        starts: list[Callable[[], spectral_tv.Job]],
        last: Callable[[list[Any]], spectral_tv.Job] | None = None,
    ) -> None:
        """Start the first of ``starts``."""
        self._starts = starts
        self._last = last
        self._results: list[Any] = []
        self._is_last = False
        self._job = starts[0]()

    @property
    def progress(self) -> float:
        """The fraction of the work done, in [0, 1]."""
        if self._is_last:
            return 1 - self.LAST * (1 - self._job.progress)
        before = len(self._results)
        if before == len(self._starts):
            return 1.0
        share = 1.0 if self._last is None else 1 - self.LAST
        return share * (before + self._job.progress) / len(self._starts)

    @property
    def done(self) -> bool:
        """Whether all have ended, or one has failed; starts the next one."""
        if not self._job.done:
            return False
        if self._is_last or len(self._results) == len(self._starts):
            return True
        try:
            self._results.append(self._job.result())
        except (spectral_tv.MeshError, spectral_tv.Cancelled, RuntimeError, MemoryError):
            return True  # whoever asks for the result learns why
        if len(self._results) < len(self._starts):
            self._job = self._starts[len(self._results)]()
        elif self._last is None:
            return True
        else:
            self._job = self._last(self._results)
            self._is_last = True
            self._results = []
        return False

    def cancel(self) -> None:
        """Ask the one that runs to stop."""
        self._job.cancel()

    def result(self) -> Any:
        """Return the last one's result, or all; raises what the one that failed raised."""
        if self._last is None and len(self._results) == len(self._starts):
            return self._results
        return self._job.result()


@dataclass(frozen=True, eq=False)
class Running:
    """A job under way, and the name and state of what it is of from when it was started."""

    job: spectral_tv.Job | Chain
    name: str
    state: str
    message: str


_running: Running | None = None


def start(job: spectral_tv.Job | Chain, name: str, state: str, message: str) -> Running:
    """Take a job over; it is cancelled when Blender loads a file or disables the extension."""
    global _running  # noqa: PLW0603 - it lives as long as the module
    _running = Running(job, name, state, message)
    return _running


def running() -> Running | None:
    """The job under way, if any."""
    return _running


def finish() -> None:
    """Let go of the job; cancels it if it still runs, without waiting."""
    global _running  # noqa: PLW0603 - it lives as long as the module
    if _running is not None:
        _running.job.cancel()
    _running = None


def state_of(obj: bpy.types.Object) -> str:
    """Digest of all of an object that a result depends on."""
    return topology_digest(obj.data) + digest(basis_coordinates(obj.data))
