"""A pin and a handle by clicks on the mesh, and what is drawn over it meanwhile and then."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence

import bpy
from bpy_extras import view3d_utils
from contents import contents, differences
from deform import MODULE, held_dumbbell, leaning, new_dumbbell, running
from pictures import away
from screen import (
    PICTURES,
    Steps,
    click,
    find,
    in_view,
    key,
    move,
    picture,
    region,
    told,
    until,
    xdotool,
)

FOOT, CROWN, SIDE = (0, -0.6, -2.268), (0, -0.6, 2.268), (0.7, -0.7, -1.468)
BUTTON = "spectral_tv.hold_and_pull("


def hold_and_pull() -> Steps[None]:
    yield from prepare()
    yield from nothing_comes_of_a_cancelled_one()
    yield from hold_two_and_take_one_back()
    yield from click_twice_and_pull()
    yield from what_is_held_is_seen()
    yield from adjust_it()
    yield from stay_in_local_view()


def prepare() -> Steps[None]:
    """A dumbbell from the front, without vertex groups."""
    obj = new_dumbbell()
    obj.vertex_groups.clear()
    yield from away()
    yield from key("KP_1")
    yield from key("KP_Decimal")
    yield 0.5
    bpy.ops.ed.undo_push(message="Dumbbell")


def nothing_comes_of_a_cancelled_one() -> Steps[None]:
    before = contents()
    for end in ("Escape", "mouse"):
        yield from begin()
        yield from click(*seen(FOOT))
        assert len(picking().held) == 1
        yield from click(*seen((3, 0, 0)))  # beside it
        if end == "mouse":
            xdotool("click", 3)
        else:
            yield from key(end)
        yield from until(lambda: picking() is None, "it to be cancelled")
        assert not differences(before, contents())
        assert not overlay()._picked
    assert (yield from told()).count("Cancelled; nothing was changed") >= 2


def hold_two_and_take_one_back() -> Steps[None]:
    """Shift-click holds more, Backspace takes back, Enter ends it without a handle."""
    before = contents()
    yield from begin()
    yield from click(*seen(FOOT))
    one = held_vertices()
    xdotool("keydown", "shift")
    yield from click(*seen(SIDE))
    xdotool("keyup", "shift")
    assert len(picking().held) == 2 and held_vertices() > one
    yield from picture("holding")
    yield from key("BackSpace")
    assert len(picking().held) == 1 and held_vertices() == one
    yield from key("Return")
    yield from until(lambda: picking() is None, "Enter to end it")
    obj = bpy.context.object
    assert [each.kind for each in obj.spectral_tv.constraints] == ["PIN"]
    assert obj.name == "Dumbbell"
    yield from away()
    yield from key("ctrl+z")
    assert not differences(before, contents())


def click_twice_and_pull() -> Steps[None]:
    """Drag out what stays, click what moves, press G: the mesh follows. Undo takes it all back."""
    before = contents()
    yield from begin()
    x, y = seen(FOOT)
    yield from move(x, y)
    xdotool("mousedown", 1)
    counts = []
    for _ in range(12):
        xdotool("mousemove_relative", "--", 8, 0)
        yield 0.1
        counts.append(held_vertices())
    grown = counts[2:]  # by then it is clear that the mouse is dragged
    assert grown == sorted(grown) and 2 * grown[0] < grown[-1], f"it does not grow: {counts}"
    yield from picture("holding_dragged")
    xdotool("mouseup", 1)
    yield 0.2
    yield from click(*seen(CROWN))
    yield from until(lambda: picking() is None, "the second click to end it")
    obj = bpy.data.objects["Dumbbell"]
    assert [each.kind for each in obj.spectral_tv.constraints] == ["PIN", "OBJECT"]
    handle = bpy.context.object
    assert handle == obj.spectral_tv.constraints[1].target and handle.select_get()
    assert not obj.select_get()
    yield from until(lambda: running() is not None, "Live to begin")
    yield from until(
        lambda: obj.data.shape_keys is not None and top(obj) is not None, "the shape key"
    )
    rest = handle.matrix_world.translation.x
    yield from key("g")
    yield from key("x")
    xdotool("mousemove_relative", "--", 60, 0)
    yield 0.3
    yield from picture("pulled_at_once")
    xdotool("click", 1)
    yield 0.3
    offset = handle.matrix_world.translation.x - rest
    assert abs(offset) > 0.05
    yield from until(lambda: abs(top(obj) - offset) < 1e-3, "the mesh to follow")
    yield from key("Escape")
    yield from until(lambda: running() is None, "Live to end")
    for _ in range(3):  # Live, the move, and the constraints
        yield from key("ctrl+z")
    found = differences(before, contents())
    assert not found, found
    for _ in range(3):
        yield from key("ctrl+shift+z")
    obj = bpy.data.objects["Dumbbell"]
    assert abs(top(obj) - offset) < 1e-3


def what_is_held_is_seen() -> Steps[None]:
    """In the colors of pins and handles, where the mesh is shown now, unless it is switched off."""
    obj = bpy.data.objects["Dumbbell"]
    offset = top(obj)
    bpy.context.view_layer.objects.active = obj
    areas = bpy.context.window_manager.windows[0].screen.areas
    view = next(area for area in areas if area.type == "VIEW_3D").spaces.active
    # Beside the empty and the axis.
    foot, crown = (0.2, *FOOT[1:]), (offset + 0.2, *CROWN[1:])
    for name in ("held_shown", "held_in_perspective"):
        yield from away()
        yield from picture(name)
        foot_color, crown_color = colors(name, [foot, crown])
        assert is_blue(foot_color) and is_orange(crown_color), (name, foot_color, crown_color)
        yield from key("KP_5")
        yield 0.5
    for switch in ("overlays", "regions", "hiding"):
        if switch == "overlays":
            view.overlay.show_overlays = False
        elif switch == "regions":
            yield from click(*(yield from find("spectral_tv.shows_regions", column=0.6)))
            assert not obj.spectral_tv.shows_regions
            yield from away()
        else:
            obj.hide_set(True)
        yield from picture(f"held_hidden_{switch}")
        for color in colors(f"held_hidden_{switch}", [foot, crown]):
            assert max(color) - min(color) < 30, f"{switch}: {color} is not grey"
        view.overlay.show_overlays = obj.spectral_tv.shows_regions = True
        obj.hide_set(False)
    obj.name = "Renamed"
    obj.vertex_groups["Pin"].name = "Foot"  # which the constraint does not know
    yield from away()
    yield from picture("held_renamed")
    foot_color, crown_color = colors("held_renamed", [foot, crown])
    assert not is_blue(foot_color) and is_orange(crown_color), (foot_color, crown_color)
    obj.vertex_groups["Foot"].name = "Pin"
    obj.name = "Dumbbell"
    obj.modifiers.new("Subdivision", "SUBSURF")
    yield from away()
    yield from picture("held_subdivided")
    foot_color, crown_color = colors("held_subdivided", [foot, crown])
    assert is_blue(foot_color) and is_orange(crown_color), (foot_color, crown_color)
    obj.modifiers.clear()


def adjust_it() -> Steps[None]:
    """Adjust Last Operation makes the same again of the places that were clicked on."""
    yield from prepare()
    with in_view():
        bpy.ops.spectral_tv.hold_and_pull("INVOKE_DEFAULT", live=False)
    yield from click(*seen(FOOT))
    yield from click(*seen(CROWN))
    yield from until(lambda: picking() is None, "the second click to end it")
    yield from away()
    after = contents()
    with in_view():
        bpy.ops.ed.undo_redo()
    found = differences(after, contents())
    assert not found, found
    assert bpy.context.object.name.startswith("Dumbbell Handle")


def stay_in_local_view() -> Steps[None]:
    """What is pulled is drawn there, and the empty is there too."""
    obj = new_dumbbell()
    with in_view():
        bpy.ops.view3d.localview(frame_selected=False)
        place = {"name": "", "point": CROWN, "radius": 0.5}
        bpy.ops.spectral_tv.hold_and_pull(held=[], pulled=[place])
    yield from away()
    yield from picture("held_in_local_view")
    with in_view():
        handle = obj.spectral_tv.constraints[0].target
        seen_one = handle.evaluated_get(bpy.context.evaluated_depsgraph_get())
        assert seen_one.local_view_get(bpy.context.space_data)
        bpy.ops.view3d.localview(frame_selected=False)
    crown_color, foot_color = colors("held_in_local_view", [(0.2, *CROWN[1:]), (0.2, *FOOT[1:])])
    assert is_orange(crown_color) and not is_orange(foot_color), (crown_color, foot_color)
    held_dumbbell()  # as what comes next has it


def begin() -> Steps[None]:
    yield from click(*(yield from find(BUTTON)))
    yield from until(lambda: picking() is not None, "it to begin")


def picking() -> bpy.types.Operator | None:
    module = sys.modules[f"{MODULE}.deformation.pick_operator"]
    return module.SPECTRAL_TV_OT_hold_and_pull.running


def overlay():
    return sys.modules[f"{MODULE}.deformation.overlay"]


def held_vertices() -> int:
    (picked,) = overlay()._picked.values()
    return len(picked.held)


def top(obj: bpy.types.Object) -> float:
    """How far the middle of what is pulled has moved along X: it is free to turn about it."""
    return leaning(obj, obj.spectral_tv.constraints[1].vertex_group)


def seen(point: Sequence[float]) -> tuple[int, int]:
    """Where a point of the world is in the window, in pixels from its lower left."""
    view = region("WINDOW")
    x, y = view3d_utils.location_3d_to_region_2d(view, view.data, point)
    return int(view.x + x), int(view.y + y)


def colors(name: str, points: Sequence[Sequence[float]]) -> list[tuple[int, ...]]:
    """The colors in a picture, in 0 to 255, where points of the world are."""
    height = bpy.context.window_manager.windows[0].height
    found = []
    for x, y in map(seen, points):
        wanted = "%[fx:round(255*p{{{0},{1}}}.{2})]"
        text = " ".join(wanted.format(x, height - y, channel) for channel in "rgb")
        command = ["convert", str(PICTURES / f"{name}.png"), "-format", text, "info:"]
        done = subprocess.run(command, check=True, capture_output=True, text=True)
        found.append(tuple(int(value) for value in done.stdout.split()))
    return found


def is_blue(color: tuple[int, ...]) -> bool:
    return color[2] > color[0] + 40


def is_orange(color: tuple[int, ...]) -> bool:
    return color[0] > color[2] + 40
