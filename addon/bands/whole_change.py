"""Undo of a change and of the bands that follow it, as one.

Blender makes a step of undo when a setting is changed, and another one when the bands are written.
Undo and redo go over the steps between. The scene has a mark that tells which they are. What
Blender tells of only after its step, as of a curve, gets a step of its own that has the mark.
"""

import uuid
from collections.abc import Callable
from functools import partial

import bpy

from ..scene import listening

# How far a change is: made; its preview was written; what was written is final; under way, which a
# step of undo has only if the user did something else meanwhile.
MADE, PREVIEWED, DONE, UNDER_WAY = "made", "previewed", "done", "under way"


class _Known:
    """The changes of this session that bands followed, those that all of them followed, and those
    that a newer change took the place of; and the mark from which undo or redo comes."""

    followed: set[str] = set()
    finished: set[str] = set()
    replaced: set[str] = set()
    # Of those whose first step has no mark: tells whether that is where undo or redo has led to.
    trailing: dict[str, Callable[[], bool]] = {}
    before: tuple[str, str] = ("", "")


def mark(scene: bpy.types.Scene, change: str, stage: str) -> None:
    """Mark how far a change is, an identifier of it; "" if there is none."""
    scene.spectral_tv.change = f"{change} {stage}" if change else ""
    if stage in (PREVIEWED, DONE):
        _Known.followed.add(change)
    if stage == DONE:
        _Known.finished.add(change)


def give_way(change: str) -> None:
    """Take note that a newer change takes the place of one that nothing followed."""
    if change and change not in _Known.followed:
        _Known.replaced.add(change)


def make_step(scene: bpy.types.Scene, message: str, is_first: Callable[[], bool]) -> None:
    """Make the step of undo that follows one without a mark; ``is_first`` tells whether the state
    is that of this one, without what followed."""
    change = uuid.uuid4().hex
    mark(scene, change, DONE)
    _Known.trailing[change] = is_first
    bpy.ops.ed.undo_push(message=message)


def marked(scene: bpy.types.Scene) -> tuple[str, str]:
    """The change and the stage that a scene is marked by."""
    change, _, stage = scene.spectral_tv.change.partition(" ")
    return change, stage


def goes_on(before: tuple[str, str], now: tuple[str, str], is_undo: bool) -> bool:
    """Whether undo or redo that led from one mark to the next one goes on."""
    (former, came_from), (change, stage) = before, now
    trailing = _Known.trailing
    if not is_undo and any(is_first() for other, is_first in trailing.items() if other != change):
        return True
    if is_undo and former != change and former in trailing and trailing[former]():
        return True
    if before == now or stage not in (MADE, PREVIEWED):
        return False
    if change in _Known.replaced:
        return True
    if is_undo:
        return change in _Known.followed and came_from in (MADE, PREVIEWED, DONE)
    return change in (_Known.finished if stage == PREVIEWED else _Known.followed)


def start() -> None:
    """Listen to undo and redo; loading a file ends it."""
    listening.listen(_handlers())


def stop() -> None:
    """Listen no more."""
    listening.ignore(_handlers())
    forget()


def forget() -> None:
    """Let go of what is known."""
    for known in (_Known.followed, _Known.finished, _Known.replaced, _Known.trailing):
        known.clear()
    for again in (_undo_again, _redo_again):
        if bpy.app.timers.is_registered(again):
            bpy.app.timers.unregister(again)


def step_on(is_undo: bool) -> bool:
    """Go one step on, if that belongs to the change; tells whether."""
    now = marked(bpy.context.scene)
    if not goes_on(_Known.before, now, is_undo):
        return False
    (bpy.ops.ed.undo if is_undo else bpy.ops.ed.redo)()
    return True


def _handlers() -> list[listening.Handler]:
    handlers = bpy.app.handlers
    return [
        (handlers.undo_pre, _leave),
        (handlers.redo_pre, _leave),
        (handlers.undo_post, _undone),
        (handlers.redo_post, _redone),
    ]


def _leave(*_arguments: object) -> None:
    _Known.before = marked(bpy.context.scene)


def _arrive(is_undo: bool, again: Callable[[], None]) -> None:
    # Undo within undo is not possible.
    is_on = goes_on(_Known.before, marked(bpy.context.scene), is_undo)
    if is_on and not bpy.app.background and not bpy.app.timers.is_registered(again):
        bpy.app.timers.register(again, first_interval=0)


def _again(is_undo: bool) -> None:
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
        step_on(is_undo)


_undo_again, _redo_again = partial(_again, True), partial(_again, False)


def _undone(*_arguments: object) -> None:
    _arrive(True, _undo_again)


def _redone(*_arguments: object) -> None:
    _arrive(False, _redo_again)
