"""Undo of sliders in Sculpt Mode.

There Blender makes no step of undo for a property. So Undo would go back to before the
decomposition, and take that along. Here a step is made once a band has come to rest.
"""

import bpy

from ..scene import listening
from ..scene.mix import sliders_of
from ..scene.records import record_of

STEP = "Set Bands"


class _Watch:
    """What was last seen of the active object, and what its last step of undo has."""

    seen: tuple | None = None
    stepped: tuple | None = None


def start() -> None:
    """Begin to watch; loading a file ends it."""
    listening.listen(_handlers())


def stop() -> None:
    """Watch no more."""
    listening.ignore(_handlers())
    forget()


def forget() -> None:
    """Let go of what was seen."""
    _Watch.seen = _Watch.stepped = None
    listening.stop_awaiting(_rest)


def make_step() -> bool:
    """Make a step of undo, if bands have other values than in the last one; tells whether."""
    now = _state()
    is_new = now is not None and _Watch.stepped is not None and now != _Watch.stepped
    is_other = is_new and now[:2] != _Watch.stepped[:2]
    _Watch.stepped = now
    if not is_new or is_other:
        return False
    bpy.ops.ed.undo_push(message=STEP)
    return True


def _handlers() -> list[listening.Handler]:
    return listening.changes(_notice, _distrust)


def _state() -> tuple | None:
    """The object and the frame, and the values and mutes of its keys; None if it is not sculpted
    or has no bands."""
    obj = bpy.context.view_layer.objects.active
    if obj is None or obj.mode != "SCULPT" or record_of(obj) is None:
        return None
    keys = sliders_of(obj)
    frame = bpy.context.scene.frame_current
    return (obj.session_uid, frame, tuple((key.name, key.value, key.mute) for key in keys))


def _notice(_scene: bpy.types.Scene, _graph: bpy.types.Depsgraph) -> None:
    now = _state()
    if now is None or _Watch.stepped is None or now[:2] != _Watch.stepped[:2]:
        _Watch.seen = _Watch.stepped = now
        return
    if now == _Watch.seen:
        return
    _Watch.seen = now
    listening.await_rest(_rest)


def _rest() -> None:
    make_step()


def _distrust(*_arguments: object) -> None:
    _Watch.seen = _Watch.stepped = _state()
