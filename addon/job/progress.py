"""How progress is shown: at the mouse cursor, or in the sidebar."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import bpy


@contextmanager
def cursor_progress(context: bpy.types.Context) -> Iterator[Callable[[float], None]]:
    """Yield a function that takes the fraction done, in [0, 1], of work that blocks."""
    manager = context.window_manager
    manager.progress_begin(0, 100)
    try:
        yield lambda fraction: manager.progress_update(100 * fraction)
    finally:
        manager.progress_end()


def redraw_sidebars(context: bpy.types.Context) -> None:
    """Have the sidebars drawn anew that show progress."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in ("VIEW_3D", "IMAGE_EDITOR"):
                for region in area.regions:
                    if region.type == "UI":
                        region.tag_redraw()
