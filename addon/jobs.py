"""The one job that may run: work in a native thread, on copies, that never touches Blender."""

from dataclasses import dataclass

import bpy
import spectral_tv

from .records import digest, topology_digest
from .surface import basis_coordinates


@dataclass(frozen=True)
class Running:
    """A job under way, and what its object looked like when it was started."""

    job: spectral_tv.Job
    object_name: str
    state: str
    message: str


_running: Running | None = None


def start(job: spectral_tv.Job, obj: bpy.types.Object, message: str) -> None:
    """Take a job over; it is cancelled when Blender loads a file or disables the extension."""
    global _running  # noqa: PLW0603
    _running = Running(job, obj.name, state_of(obj), message)


def running() -> Running | None:
    """The job under way, if any."""
    return _running


def finish() -> None:
    """Let go of the job; cancels it if it still runs, without waiting."""
    global _running  # noqa: PLW0603
    if _running is not None:
        _running.job.cancel()
    _running = None


def state_of(obj: bpy.types.Object) -> str:
    """Digest of all that a result depends on."""
    return topology_digest(obj.data) + digest(basis_coordinates(obj.data))
