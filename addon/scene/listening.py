"""Listening to what Blender tells of: updates, undo, frames."""

from collections.abc import Callable, Iterable

import bpy

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
