"""Progress of blocking work, shown at the mouse cursor."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import bpy


@contextmanager
def cursor_progress(context: bpy.types.Context) -> Iterator[Callable[[float], None]]:
    """Yield a function that takes the fraction done, in [0, 1]."""
    manager = context.window_manager
    manager.progress_begin(0, 100)
    try:
        yield lambda fraction: manager.progress_update(100 * fraction)
    finally:
        manager.progress_end()
