"""The event timers of modal operators.

Blender tells an operator when it ends it, but not when the operator's class is unregistered.
"""

import bpy

_timers: list[bpy.types.Timer] = []


def add(context: bpy.types.Context, seconds: float) -> bpy.types.Timer:
    """Send events to the window of ``context``, so many seconds apart."""
    timer = context.window_manager.event_timer_add(seconds, window=context.window)
    _timers.append(timer)
    return timer


def remove(timer: bpy.types.Timer) -> None:
    """Send no more."""
    if timer in _timers:
        _timers.remove(timer)
        bpy.context.window_manager.event_timer_remove(timer)


def remove_all() -> None:
    """Remove those of operators that are about to end."""
    for timer in list(_timers):
        remove(timer)
