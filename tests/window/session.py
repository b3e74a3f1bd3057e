"""A user's session with the sidebar; Blender runs this: see run.sh."""

from __future__ import annotations

import sys
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))

from at_once import at_once
from deform import deform
from deviation import deviation
from hold_and_pull import hold_and_pull
from maps import maps
from masks import masks
from others import others
from pictures import messages, new_monkey, panels
from recipes import recipes
from screen import (
    PICTURES,
    Steps,
    centre,
    click,
    drag,
    find,
    key,
    move,
    picture,
    region,
    run,
    until,
)
from sculpt import sculpt

BANDS = 5


def session() -> Steps[None]:
    yield from prepare()
    yield from open_tab()
    yield from decompose()
    yield from watch()
    yield from cancel_with_esc()
    yield from decompose()
    yield from cancel_with_the_button()
    yield from finish()
    yield from adjust_last_operation()
    yield from drag_a_slider()
    yield from undo_and_redo()
    yield from masks()
    yield from deviation()
    yield from maps()
    yield from panels()
    yield from deform()
    yield from hold_and_pull()
    yield from others()
    yield from messages()
    yield from sculpt()
    yield from recipes()
    yield from at_once()
    yield from quit_while_it_runs()


def prepare() -> Steps[None]:
    """A mesh that takes a while."""
    new_monkey(subdivisions=4)
    bpy.context.scene.spectral_tv.steps = 32
    bpy.ops.ed.undo_push(message="Prepare")
    yield 1


def open_tab() -> Steps[None]:
    """N opens the sidebar; its tabs are tried from the top, as no interface tells their places."""
    yield from move(*centre(region("WINDOW")))
    yield from key("KP_Decimal")
    yield from key("n")
    sidebar = region("UI")
    for y in range(sidebar.y + sidebar.height - 10, sidebar.y, -15):
        yield from click(sidebar.x + sidebar.width - 8, y)
        if sidebar.active_panel_category == "Spectral TV":
            break
    assert sidebar.active_panel_category == "Spectral TV"
    yield from picture("1_tab")
    bpy.context.scene.spectral_tv.steps = 200  # enough for a minute's work


def decompose() -> Steps[None]:
    """Press the button."""
    yield from click(*(yield from find("spectral_tv.decompose")))
    yield from until(is_running, "the decomposition to start")


def watch() -> Steps[None]:
    """Progress is shown, and the window answers meanwhile."""
    seen = {progress()}
    while len(seen) < 4 or progress() < 0.1:
        yield from until(lambda: progress() not in seen or not is_running(), "progress")
        assert is_running(), f"was over after {sorted(seen)}"
        seen.add(progress())
    assert sorted(seen)[1] > 0
    assert sorted(seen)[-1] < 1
    yield from move(*centre(region("WINDOW")))
    before = region("WINDOW").data.view_matrix.copy()
    yield from key("KP_1")
    yield from until(lambda: region("WINDOW").data.view_matrix != before, "the view to turn")
    assert is_running()
    yield from picture("2_progress")


def cancel_with_esc() -> Steps[None]:
    yield from key("Escape")
    yield from until(lambda: not is_running(), "Esc to cancel")
    yield from picture("3_cancelled")
    assert bands() == []


def cancel_with_the_button() -> Steps[None]:
    yield from click(*(yield from find("spectral_tv.cancel", column=0.82)))
    yield from until(lambda: not is_running(), "the button to cancel")
    yield 1
    assert bands() == []


def finish() -> Steps[None]:
    bpy.context.scene.spectral_tv.steps = 16
    yield from decompose()
    yield from until(lambda: not is_running(), "the decomposition to end")
    assert [band.value for band in bands()] == [0] * BANDS
    yield from picture("4_bands")


def adjust_last_operation() -> Steps[None]:
    """F9 cuts the bands anew; its fields are to the lower right of the mouse."""
    x, y = centre(region("WINDOW"))
    yield from move(x, y)
    yield from key("F9")
    yield from picture("5_adjust")
    manager = bpy.context.window_manager
    for below in range(30, 120, 8):
        yield from move(x + 205, y - below)
        yield from key("ctrl+c")
        if manager.clipboard == str(BANDS):
            break
    for count in (BANDS + 2, BANDS):
        manager.clipboard = str(count)
        yield from key("ctrl+v")
        yield from until(lambda count=count: len(bands()) == count, f"{count} bands")
    yield from move(10, 10)  # which closes it
    assert [operator.name for operator in manager.operators] == ["Decompose into Bands"]


def drag_a_slider() -> Steps[None]:
    yield from drag(*(yield from find('Band 4"].value')), 40)
    yield from move(*centre(region("WINDOW")))
    values = [band.value for band in bands()]
    assert values[3] > 0.1
    assert values[:3] + values[4:] == [0] * (BANDS - 1)
    guard = sys.modules["bl_ext.user_default.spectral_tv.bands.live_guard"]
    (drawn,) = [each.line for each in guard._watched.values()]
    assert drawn == guard.count(monkey()), "the line under the sliders does not follow them"
    yield from picture("6_slider")


def undo_and_redo() -> Steps[None]:
    """One step back is the slider, the next one the decomposition."""
    yield from key("ctrl+z")
    yield from until(lambda: len(bands()) == BANDS and bands()[3].value == 0, "undo of the slider")
    yield from picture("7_undone")
    yield from key("ctrl+z")
    yield from until(lambda: bands() == [], "undo of the decomposition")
    assert len(monkey().data.vertices) > 100_000, "undid more than the decomposition"
    yield from key("ctrl+shift+z")
    yield from until(lambda: len(bands()) == BANDS, "redo of the decomposition")


def quit_while_it_runs() -> Steps[None]:
    new_monkey(subdivisions=4)
    bpy.context.scene.spectral_tv.steps = 200
    yield from decompose()
    (PICTURES / "session.passed").touch()
    bpy.ops.wm.quit_blender()


def monkey() -> bpy.types.Object:
    return bpy.data.objects["Suzanne"]


def bands() -> list[bpy.types.ShapeKey]:
    """The bands' shape keys; without them, none at all."""
    keys = monkey().data.shape_keys
    return [] if keys is None else list(keys.key_blocks)[1:]


def progress() -> float:
    return bpy.context.window_manager.spectral_tv.progress


def is_running() -> bool:
    return bpy.ops.spectral_tv.cancel.poll()


bpy.context.preferences.view.show_splash = False
addon = bpy.context.preferences.addons["bl_ext.user_default.spectral_tv"]
addon.preferences.research_tools = True
run(session())
