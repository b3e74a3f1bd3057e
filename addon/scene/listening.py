"""Listening to what Blender tells of: updates, undo, frames; and waiting until it rests."""

from collections.abc import Callable, Iterable

import bpy

# Seconds without a change after which a slider is let go of.
REST = 0.4
# One of the lists in bpy.app.handlers, and what is called.
Handler = tuple[list, Callable[..., None]]


def listen(handlers: Iterable[Handler]) -> None:
    """Have each called from now on, once."""
    for known, handler in handlers:
        if handler not in known:
            known.append(handler)


def ignore(handlers: Iterable[Handler]) -> None:
    """Have none of them called any more."""
    for known, handler in handlers:
        if handler in known:
            known.remove(handler)


def changes(notice: Callable[..., None], distrust: Callable[..., None]) -> list[Handler]:
    """What is called on each update, and what on each undo and redo."""
    handlers = bpy.app.handlers
    return [
        (handlers.depsgraph_update_post, notice),
        (handlers.undo_post, distrust),
        (handlers.redo_post, distrust),
    ]


def await_rest(action: Callable[[], None]) -> None:
    """Have an action called once, when this was not asked for during a rest."""
    stop_awaiting(action)
    bpy.app.timers.register(action, first_interval=REST)


def is_awaiting(action: Callable[[], None]) -> bool:
    """Whether it will be called."""
    return bpy.app.timers.is_registered(action)


def stop_awaiting(action: Callable[[], None]) -> None:
    """Have it not be called."""
    if is_awaiting(action):
        bpy.app.timers.unregister(action)
