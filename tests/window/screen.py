"""Hands and eyes in Blender's window: real events by xdotool, pictures by ImageMagick.

Functions that take time are generators. They yield the seconds to wait, in which Blender handles
the events; Blender's timer runs them.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
import traceback
from collections.abc import Callable, Generator, Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TypeVar

import bpy

T = TypeVar("T")
Steps = Generator[float, None, T]

PICTURES = Path(os.environ["PICTURES"])
PATIENCE = 60  # seconds until what is waited for counts as missing

# The height at which each text was found last, in its column.
_places: dict[tuple[str, float], int] = {}


def run(steps: Iterator[float]) -> None:
    """Run the steps to their end in the open window; Blender exits with 1 if one fails."""

    def tick() -> float | None:
        try:
            return next(steps)
        except StopIteration:
            return None
        except BaseException:
            traceback.print_exc()
            sys.stderr.flush()
            try:
                _import("failure")
            finally:
                os._exit(1)

    bpy.app.timers.register(tick, first_interval=1, persistent=True)


def until(condition: Callable[[], bool], what: str) -> Steps[None]:
    """Wait for ``condition``; fails if it does not come about."""
    started = time.monotonic()
    while not condition():
        assert time.monotonic() - started < PATIENCE, f"waited in vain: {what}"
        yield 0.05


def picture(name: str) -> Steps[None]:
    """Keep a picture of the screen, once it is drawn."""
    yield 0.5
    _import(name)


def region(kind: str) -> bpy.types.Region:
    """Return the region of this kind in the 3D view."""
    return next(region for region in _view_3d().regions if region.type == kind)


def centre(area: bpy.types.Region) -> tuple[int, int]:
    """Return the middle of a region, in pixels from the window's lower left."""
    return area.x + area.width // 2, area.y + area.height // 2


def move(x: int, y: int) -> Steps[None]:
    """Move the mouse."""
    xdotool("mousemove", x, _window().height - y)
    yield 0.1


def click(x: int, y: int) -> Steps[None]:
    """Press and release the left button."""
    yield from move(x, y)
    xdotool("click", 1)
    yield 0.2


def drag(x: int, y: int, distance: int) -> Steps[None]:
    """Drag to the right."""
    yield from move(x, y)
    xdotool("mousedown", 1)
    for _ in range(10):
        yield 0.05
        xdotool("mousemove_relative", "--", distance // 10, 0)
    yield 0.1
    xdotool("mouseup", 1)
    yield 0.2


def key(name: str) -> Steps[None]:
    """Press and release a key, or several as in ctrl+z."""
    xdotool("key", name)
    yield 0.3


def find(text: str, column: float = 0.5) -> Steps[tuple[int, int]]:
    """Find the sidebar's button or field whose Python command or data path contains ``text``.

    The mouse goes down the sidebar, as no interface of Blender tells where a button is;
    ``column`` says where between its left, 0, and its right, 1.
    """
    seen: set[str] = set()
    for _attempt in range(3):  # the window may be slow to draw
        place = yield from _look_for(text, column, seen)
        if place is not None:
            x, y = place[0], (yield from _middle(text, *place))
            _places[text, column] = y
            return x, y
    raise AssertionError(f"the sidebar has no {text}, but {sorted(seen)}")


def is_there(text: str, column: float = 0.5) -> Steps[bool]:
    """Whether the sidebar has such a button or field."""
    return (yield from _look_for(text, column, set())) is not None


def _look_for(text: str, column: float, seen: set[str]) -> Steps[tuple[int, int] | None]:
    """A place within what has the ``text``, if there is one; what else is ``seen`` on the way."""
    sidebar = region("UI")
    x = sidebar.x + int(column * sidebar.width)
    former = _places.get((text, column))  # most have not moved since
    heights = range(sidebar.y + sidebar.height - 4, sidebar.y, -12)
    for y in heights if former is None else (former, *heights):
        yield from _hover(x, y)
        if text in _under_mouse(sidebar):
            yield 0.3
            if text in _under_mouse(sidebar):
                return x, y
        seen.add(_under_mouse(sidebar))
    return None


def _middle(text: str, x: int, y: int) -> Steps[int]:
    """The height of the middle of what was found somewhere within: places are told from there."""
    ends = []
    for step in (2, -2):
        end = y
        for end in range(y, y + 20 * step, step):
            yield from _hover(x, end)
            if text not in _under_mouse(region("UI")):
                break
        ends.append(end)
    middle = sum(ends) // 2
    yield from _hover(x, middle)
    return middle


def _hover(x: int, y: int) -> Steps[None]:
    """Move the mouse, and wait until Blender knows what is under it.

    Timers run between Blender's reading of events and its handling of them. One pass handles the
    move, and one leaves the former button and enters the new one.
    """
    xdotool("mousemove", x, _window().height - y)
    yield from (0.03, 0, 0)


def in_view(window: bpy.types.Window | None = None) -> AbstractContextManager:
    """Context of the 3D view of a window, the first one if none is given, as for its buttons."""
    window = window or _window()
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    view = next(region for region in area.regions if region.type == "WINDOW")
    return bpy.context.temp_override(window=window, area=area, region=view)


def told() -> Steps[str]:
    """Return all messages so far, as the Info editor shows them."""
    area = next(area for area in _window().screen.areas if area.type != "VIEW_3D")
    former, area.type = area.type, "INFO"
    yield 0.1
    view = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=_window(), area=area, region=view):
        bpy.ops.info.select_all(action="SELECT")
        bpy.ops.info.report_copy()
    area.type = former
    return bpy.context.window_manager.clipboard


def xdotool(*arguments: str | int) -> None:
    """Send events to the X server."""
    subprocess.run(["xdotool", *map(str, arguments)], check=True)


def _under_mouse(area: bpy.types.Region) -> str:
    """Return what Blender copies for the active button: its command or data path."""
    manager = bpy.context.window_manager
    manager.clipboard = ""
    with bpy.context.temp_override(window=_window(), area=_view_3d(), region=area):
        for copy in (bpy.ops.ui.copy_python_command_button, bpy.ops.ui.copy_data_path_button):
            if copy.poll():
                copy()
    return manager.clipboard


def _window() -> bpy.types.Window:
    return bpy.context.window_manager.windows[0]


def _view_3d() -> bpy.types.Area:
    return next(area for area in _window().screen.areas if area.type == "VIEW_3D")


def _import(name: str) -> None:
    subprocess.run(["import", "-window", "root", PICTURES / f"{name}.png"], check=True)
