"""Settings that the object follows at once, sizes that are pointed at, fields without buttons."""

from __future__ import annotations

import json
from collections.abc import Callable

import bpy
from pictures import NEXT_HEADER, away, new_monkey, settings
from screen import (
    Steps,
    centre,
    click,
    drag,
    find,
    is_there,
    key,
    move,
    picture,
    region,
    until,
    xdotool,
)

FEW, MORE, COUNT = 12, 16, 7
# Steps that take too long at once, and those of a preview.
MANY, PREVIEW = 900, 8
# Where in the sidebar fields are, and the small buttons behind them.
FIELD, SWITCH = 0.7, 0.84
# From the button below the curve to the lower half of that.
ABOVE_THE_BUTTON = 90
CURVE = ".Spectral TV Filter"


def at_once() -> Steps[None]:
    """The switch, a field of it, and undo; then a size by the eyedropper, bands, and the curve."""
    new_monkey()
    unset()
    yield from away()
    bpy.ops.ed.undo_push(message="Monkey")
    yield from click(*(yield from find("spectral_tv.at_once", column=SWITCH)))
    yield from until(lambda: record() is not None, "the bands of At Once")
    yield from ends(lambda: steps() == MORE)
    yield from picture("at_once")
    yield from one_step_takes_a_change_back()
    yield from a_preview()
    yield from another_method()
    yield from a_size_from_the_view()
    yield from another_number_of_bands()
    yield from a_curve()
    unset()


def unset() -> None:
    """Have the settings of old."""
    for name in ("at_once", "method", "use_scales", "finest", "largest"):
        settings().property_unset(name)


def one_step_takes_a_change_back() -> Steps[None]:
    yield from write(*(yield from find("spectral_tv.steps", FIELD)), str(FEW))
    yield from until(lambda: steps() == FEW, "bands of other steps")
    yield from ends(lambda: settings().steps == FEW)
    yield from away()
    yield from key("ctrl+z")
    yield from until(lambda: (steps(), settings().steps) == (MORE, MORE), "undo of both")
    yield 0.5
    assert record() is not None and settings().at_once
    yield from key("ctrl+shift+z")
    yield from until(lambda: (steps(), settings().steps) == (FEW, FEW), "redo of both")
    yield from key("ctrl+z")
    yield from until(lambda: (steps(), settings().steps) == (MORE, MORE), "undo of both")
    yield from key("ctrl+z")
    yield from until(lambda: record() is None and not settings().at_once, "undo of the switch")
    yield from key("ctrl+shift+z")
    yield from until(lambda: record() is not None and settings().at_once, "redo of the switch")


def a_preview() -> Steps[None]:
    """What takes longer has one; Esc leaves it, and the next change begins anew."""
    yield from write(*(yield from find("spectral_tv.steps", FIELD)), str(MANY))
    yield from until(lambda: steps() == PREVIEW, "the preview")
    yield from until(bpy.ops.spectral_tv.cancel.poll, "the whole of it")
    yield from away()
    yield from picture("at_once_preview")
    yield from key("Escape")
    yield from until(lambda: not bpy.ops.spectral_tv.cancel.poll(), "Esc to end it")
    yield 1
    assert not bpy.ops.spectral_tv.cancel.poll() and steps() == PREVIEW
    yield from picture("at_once_stopped")
    yield from write(*(yield from find("spectral_tv.steps", FIELD)), str(MANY + 1))
    yield from until(bpy.ops.spectral_tv.cancel.poll, "the work on another change")
    # Not by the field: to find it may take longer than the work, after which it is elsewhere.
    settings().steps = FEW
    yield from until(lambda: steps() == FEW, "the work on the last change")
    yield from ends(lambda: steps() == FEW)


def another_method() -> Steps[None]:
    """Through the menu, by its key; the gains go over, and no decomposition is added."""
    keys()[3].value = 0.5
    yield from click(*(yield from find("spectral_tv.method", FIELD)))
    yield 0.3
    yield from picture("at_once_methods")
    yield from key("l")  # as it is underlined in Limbs and Head
    yield from until(lambda: record().method != "M1", "bands of another method")
    yield from ends(lambda: record().method == settings().method)
    assert len(obj().data.spectral_tv.decompositions) == 1
    assert any(band.value for band in keys())


def a_size_from_the_view() -> Steps[None]:
    """The eyedropper beside Largest: a drag on the object; Esc leaves it as it is."""
    settings().use_scales = True
    pick = "pick_size(option='largest'"
    if not (yield from is_there(pick, column=SWITCH)):  # the panel is closed
        x, y = yield from find("spectral_tv.use_scales", column=0.175)
        yield from click(x + 60, y)
    yield from away()
    yield from click(*(yield from find(pick, column=SWITCH)))
    x, y = centre(region("WINDOW"))
    yield from move(x, y)
    yield from picture("pick_size")
    yield from key("Escape")
    assert settings().largest == 0
    yield from click(*(yield from find(pick, column=SWITCH)))
    yield from drag(x, y, 60)
    yield from until(lambda: settings().largest > 0, "the size")
    largest = settings().largest
    yield from until(lambda: abs(made()["largest"] - largest / 100) < 1e-6, "bands of that size")
    yield from away()
    yield from picture("at_once_scales")


def another_number_of_bands() -> Steps[None]:
    identifier = record().identifier
    yield from write(*(yield from find("spectral_tv_count.bands", FIELD)), str(COUNT))
    yield from until(lambda: len(keys()) == COUNT, "another number of bands")
    assert record().identifier == identifier, "it flowed again"
    yield from away()
    yield from picture("at_once_bands")
    yield from key("ctrl+z")
    yield from until(lambda: len(keys()) != COUNT, "undo of the number of bands")


def a_curve() -> Steps[None]:
    """A point that a click with Ctrl pressed adds changes the bands; undo takes both back."""
    for band in keys():
        band.value = 0
    bpy.ops.ed.undo_push(message="Reset")
    if CURVE in bpy.data.node_groups:
        bpy.data.node_groups.remove(bpy.data.node_groups[CURVE])
    if not (yield from is_there("spectral_tv.add_curve")):  # the panel is closed
        x, y = yield from find("spectral_tv.take_bands", column=0.7)
        yield from click(x - 60, y - NEXT_HEADER)
    yield from away()
    yield from click(*(yield from find("spectral_tv.add_curve")))
    x, y = yield from find("spectral_tv.apply_curve")
    xdotool("keydown", "ctrl")
    yield from click(x, y + ABOVE_THE_BUTTON)
    xdotool("keyup", "ctrl")
    yield from until(lambda: any(band.value for band in keys()), "bands that follow the curve")
    yield from away()
    yield from picture("at_once_curve")
    assert points() == 3
    yield from key("ctrl+z")
    yield from until(
        lambda: points() == 2 and not any(band.value for band in keys()), "undo of both"
    )
    yield from key("ctrl+shift+z")
    yield from until(lambda: points() == 3 and any(band.value for band in keys()), "redo of both")
    bpy.data.node_groups.remove(bpy.data.node_groups[CURVE])


def points() -> int:
    """How many the curve has."""
    return len(bpy.data.node_groups[CURVE].nodes["Filter"].mapping.curves[0].points)


def write(x: int, y: int, text: str) -> Steps[None]:
    """Paste into a field."""
    yield from move(x - 4, y)  # Blender looks what is under the mouse when it moves
    yield from move(x, y)
    yield 0.3  # until it is what the keys are for
    bpy.context.window_manager.clipboard = text
    yield from key("ctrl+v")


def ends(is_so: Callable[[], bool]) -> Steps[None]:
    yield from until(lambda: not bpy.ops.spectral_tv.cancel.poll() and is_so(), "the job to end")


def obj() -> bpy.types.Object:
    return bpy.data.objects["Suzanne"]


def record() -> bpy.types.PropertyGroup | None:
    found = obj().data.spectral_tv.decompositions
    return found[0] if found else None


def made() -> dict[str, object]:
    """What the bands were made by."""
    return {} if record() is None else json.loads(record().settings)


def steps() -> int:
    return made().get("steps", 0)


def keys() -> list[bpy.types.ShapeKey]:
    return list(obj().data.shape_keys.key_blocks)[1:]
