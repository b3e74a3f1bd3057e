"""Vertices for which a mesh was refused: kept, so that they can be shown and selected."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import bpy
import spectral_tv
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.refusal import Refusal


@dataclass(frozen=True)
class Fault:
    """A message, the vertices that it is about, and how many the mesh had."""

    message: str
    vertices: np.ndarray
    count: int


# By the names of objects; of this session, as it says nothing once the mesh was changed elsewhere.
_faults: dict[str, Fault] = {}


@contextmanager
def kept(subject: bpy.types.ID) -> Iterator[None]:
    """Keep which vertices are refused of an object while it is read, in place of those before."""
    if not isinstance(subject, bpy.types.Object) or subject.type != "MESH":
        yield
        return
    _faults.pop(subject.name, None)
    try:
        yield
    except (spectral_tv.MeshError, Refusal) as error:
        count = len(subject.data.vertices)
        vertices = np.asarray(error.vertices, dtype=np.int64)
        if len(vertices) and vertices.max() < count:
            _faults[subject.name] = Fault(str(error), vertices, count)
        raise


def of(obj: bpy.types.Object | None) -> Fault | None:
    """What is kept of ``obj``, unless it has other vertices since."""
    if obj is None or obj.type != "MESH":
        return None
    fault = _faults.get(obj.name)
    return fault if fault is not None and fault.count == len(obj.data.vertices) else None


def forget() -> None:
    """Drop all that is kept."""
    _faults.clear()
