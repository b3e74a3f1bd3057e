"""How large objects are, as sizes are relative to it: the square root of the area in the world.

Panels ask at every redraw, and an area takes time. So it is measured again only once a mesh has
been at rest for a moment, in Object Mode.
"""

import math
import time

import bpy
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np

from ..scene import listening
from ..scene.coordinates import basis_coordinates, triangles
from ..scene.modifiers import symmetries
from ..scene.objects import is_mesh
from .views import redraw_views

# Seconds without an update after which a mesh is measured again.
REST = 0.5
# Objects whose sizes are kept: those seen last.
MOST_KNOWN = 8


@dataclass
class _Measured:
    """The size of an object, what it depends on, and when Blender last updated the mesh."""

    size: float | None
    question: tuple
    mesh: int
    updated: float | None = None


# By the identifiers of objects, those seen last in the end.
_known: dict[int, _Measured] = {}


def size_of(obj: bpy.types.Object | None) -> float | None:
    """The square root of the area of a mesh object in its Basis, in units of the world.

    With Mirror modifiers the other half counts. None if there is no such object, or it has no area.
    """
    if not is_mesh(obj):
        return None
    listening.listen(_handlers())
    question, known = _question(obj), _known.pop(obj.session_uid, None)
    is_known = known is not None and known.question == question
    if is_known and known.updated is not None and obj.mode == "OBJECT":
        is_known = time.monotonic() - known.updated < REST
        if is_known and not bpy.app.timers.is_registered(_look_again):
            bpy.app.timers.register(_look_again, first_interval=REST)
    if not is_known:
        known = _Measured(_measure(obj), question, obj.data.session_uid)
    _known[obj.session_uid] = known
    while len(_known) > MOST_KNOWN:
        del _known[next(iter(_known))]
    return known.size


def size_of_active() -> float | None:
    """That of the active object."""
    return size_of(bpy.context.active_object)


def forget() -> None:
    """Let go of all that is kept, and listen no more."""
    _known.clear()
    listening.ignore(_handlers())
    if bpy.app.timers.is_registered(_look_again):
        bpy.app.timers.unregister(_look_again)


def _question(obj: bpy.types.Object) -> tuple:
    """All that it depends on, but for what Blender tells of by an update."""
    mesh = obj.data
    return (
        mesh.session_uid,
        len(mesh.vertices),
        len(mesh.loops),
        tuple(tuple(row) for row in obj.matrix_world.to_3x3()),
        _copies(obj),
    )


def _copies(obj: bpy.types.Object) -> int:
    """How many copies of the mesh its Mirror modifiers show."""
    return 2 ** sum(sum(modifier.use_axis) for modifier in symmetries(obj))


def _measure(obj: bpy.types.Object) -> float | None:
    points = basis_coordinates(obj.data) @ np.array(obj.matrix_world.to_3x3()).T
    one, two, three = (points[corner] for corner in triangles(obj.data).T)
    with np.errstate(all="ignore"):
        area = np.linalg.norm(np.cross(two - one, three - one), axis=1).sum() / 2
    size = math.sqrt(_copies(obj) * area) if math.isfinite(area) else 0.0
    return size or None


def _handlers() -> list[listening.Handler]:
    return listening.changes(_notice, _distrust)


def _notice(_scene: bpy.types.Scene, graph: bpy.types.Depsgraph) -> None:
    for update in graph.updates:
        mesh = update.id.original
        if update.is_updated_geometry and isinstance(mesh, bpy.types.Mesh):
            for each in _known.values():
                if each.mesh == mesh.session_uid:
                    each.updated = time.monotonic()


def _distrust(*_arguments: object) -> None:
    _known.clear()


def _look_again() -> None:
    redraw_views()
