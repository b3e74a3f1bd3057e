"""The one job that may run: work in a native thread, on copies, that never touches Blender."""

from collections.abc import Callable, Sequence
from typing import TypeVar

import bpy
import spectral_tv
from spectral_tv.dataclass import dataclass
from spectral_tv.jobs.steps import Work
from spectral_tv.refusal import Refusal

from ..scene.contents import digest, topology_digest
from ..scene.coordinates import basis_coordinates
from ..scene.objects import distinct_meshes, refusal
from . import faults

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class Running:
    """A job under way, and the name and state of what it is of from when it was started."""

    job: Work
    name: str
    state: str
    message: str


_running: Running | None = None


def start(job: Work, name: str, state: str, message: str) -> Running:
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


@dataclass(frozen=True)
class Seen:
    """An object by its name, and what it was like when it was read."""

    name: str
    state: str

    @classmethod
    def of(cls, obj: bpy.types.Object) -> "Seen":
        """Look at ``obj``."""
        return cls(obj.name, state_of(obj))

    def again(self) -> bpy.types.Object | None:
        """The object, if it is as it was."""
        obj = bpy.data.objects.get(self.name)
        return None if refusal(obj) is not None or state_of(obj) != self.state else obj


def all_unchanged(seen: Sequence[Seen]) -> list[bpy.types.Object]:
    """The objects; raises Refusal if one of them is not as it was."""
    found = [each.again() for each in seen]
    if None in found:
        name = seen[found.index(None)].name
        raise Refusal(f"nothing was written, as {name} changed in the meantime")
    return found


def unchanged(seen: Sequence[Seen]) -> tuple[list[bpy.types.Object | None], str]:
    """The objects that are as they were, None for others, and a text that tells which are not."""
    found = [each.again() for each in seen]
    changed = [each.name for each, obj in zip(seen, found, strict=True) if obj is None]
    text = f"; changed in the meantime and left as they are: {', '.join(changed)}"
    return found, text if changed else ""


def read_each(context: bpy.types.Context, read: Callable[[bpy.types.Object], T]) -> list[T]:
    """What is read of each mesh that is selected; raises Refusal if one cannot be read."""
    found = []
    for obj in distinct_meshes(context):
        try:
            with faults.kept(obj):
                found.append(read(obj))
        except (Refusal, spectral_tv.MeshError, MemoryError) as error:
            raise Refusal(f"{obj.name}: {error}") from error
    return found
