"""What impatient users do while they are asked to click: nothing is made, and nothing stays."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import bpy
import changes
from contents import contents, differences
from deform import MODULE, held_dumbbell, new_dumbbell
from hold_and_pull import CROWN, FOOT, overlay, picking, seen
from pictures import away
from screen import Steps, click, in_view, key, told, until


def interruptions() -> Steps[None]:
    yield from prepare()
    yield from change_it_while_picking()
    yield from begin_anew()
    yield from disable_while_picking()
    yield from reopen_while_picking()
    yield from close_the_window()


def prepare() -> Steps[None]:
    new_dumbbell()
    yield from away()
    yield from key("KP_1")
    yield from key("KP_Decimal")
    yield 0.5


def hold() -> Steps[None]:
    """Begin, and click on what stays."""
    with in_view():
        bpy.ops.spectral_tv.hold_and_pull("INVOKE_DEFAULT")
    yield from click(*seen(FOOT))
    assert len(picking().held) == 1 and overlay()._picked


def change_it_while_picking() -> Steps[None]:
    for change in (
        changes.delete,
        changes.rename,
        changes.edit,
        changes.exchange_the_mesh,
        changes.undo,
        changes.enter_edit_mode,
        changes.another_scene,
    ):
        obj = new_dumbbell()
        bpy.ops.ed.undo_push(message="Dumbbell")
        bpy.ops.ed.undo_push(message="Nothing")
        yield from hold()
        change(obj)
        after = contents()
        yield from away()
        if change not in (changes.undo, changes.another_scene):
            yield from until(lambda: picking() is None, f"{change.__name__} to end it")
            assert "nothing was made, as it changed" in (yield from told())
        else:  # the object is the same again
            yield from key("Escape")
            assert picking() is None
        assert not overlay()._picked
        assert not differences(after, contents())
        if bpy.context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")


def begin_anew() -> Steps[None]:
    """The one before ends."""
    obj = new_dumbbell()
    yield from hold()
    yield from hold()
    yield from click(*seen(CROWN))
    yield from until(lambda: picking() is None, "the second click to end it")
    assert len(obj.spectral_tv.constraints) == 2
    yield from key("Escape")  # Live


def disable_while_picking() -> Steps[None]:
    new_dumbbell()
    yield from hold()
    before = contents()
    bpy.ops.preferences.addon_disable(module=MODULE)
    assert f"{MODULE}.deformation.overlay" not in sys.modules or overlay()._handle is None
    yield from away()
    yield from click(*seen(CROWN))
    bpy.ops.preferences.addon_enable(module=MODULE)
    yield 0.3
    assert not differences(before, contents())
    held_dumbbell()
    yield from away()
    assert overlay()._known, "it is not drawn again"


def reopen_while_picking() -> Steps[None]:
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder) / "held.blend")
        held_dumbbell()
        bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False)
        saved = contents()
        yield from away()
        with in_view():
            bpy.ops.spectral_tv.hold_and_pull("INVOKE_DEFAULT")
        yield 0.3
        bpy.ops.wm.open_mainfile(filepath=path)
        yield 0.5
        assert picking() is None and not overlay()._picked
        yield from away()
        assert not differences(saved, contents())
        assert overlay()._known, "it is not drawn in the file that was opened"


def close_the_window() -> Steps[None]:
    new_dumbbell()
    with in_view():
        bpy.ops.wm.window_new()
    yield 1
    second = bpy.context.window_manager.windows[-1]
    if not any(area.type == "VIEW_3D" for area in second.screen.areas):
        second.screen.areas[0].type = "VIEW_3D"
        yield 0.2
    with in_view(second):
        bpy.ops.spectral_tv.hold_and_pull("INVOKE_DEFAULT")
    yield 0.3
    assert picking() is not None
    with in_view(second):
        bpy.ops.wm.window_close()
    yield from until(lambda: picking() is None, "it to end with its window")
    assert not overlay()._picked
