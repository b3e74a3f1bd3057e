"""The original by its button, and the deviation in color, with its legend."""

from __future__ import annotations

import bpy
from others import HEADER
from pictures import NEXT_HEADER, away, new_monkey
from screen import Steps, click, find, in_view, key, picture, until


def deviation() -> Steps[None]:
    """Of a recipe: the original and back, colors on and off, held within a limit, and undo."""
    obj = new_monkey()
    with in_view():
        bpy.ops.spectral_tv.recipe("EXEC_DEFAULT", True, recipe="Exaggerate Skin")
    yield from away()
    place = yield from find("spectral_tv.show_original(")
    yield from click(*place)
    yield from until(lambda: all(mutes(obj)), "the original")
    yield from away()
    yield from picture("original_shown")
    yield from click(*(yield from find("spectral_tv.show_original(")))
    yield from until(lambda: not any(mutes(obj)), "the look")
    yield from away()
    yield from key("KP_1")
    yield from key("KP_Decimal")
    x, y = yield from find("spectral_tv.take_bands", column=0.7)
    yield from click(x - 60, y - NEXT_HEADER - 2 * HEADER)
    yield from click(*(yield from find("shows_deviation", column=0.3)))
    yield from until(lambda: obj.data.spectral_tv.shows_deviation, "the colors")
    yield from away()
    yield from picture("deviation_shown")
    bpy.context.scene.spectral_tv_deviation.limit = 0.01
    yield from away()
    yield from click(*(yield from find("spectral_tv.limit_movement(", column=0.3)))
    yield from until(lambda: "Exaggerate Skin Limit" in obj.vertex_groups, "the limit")
    yield from away()
    yield from picture("deviation_limited")
    yield from key("ctrl+z")
    yield from until(lambda: not bpy.context.object.vertex_groups, "undo of the limit")
    obj = bpy.context.object
    yield from click(*(yield from find("shows_deviation", column=0.3)))
    yield from until(lambda: not obj.data.spectral_tv.shows_deviation, "the colors to go")
    yield from away()
    yield from picture("deviation_hidden")
    x, y = yield from find("spectral_tv_deviation.limit", column=0.3)
    yield from click(x, y + HEADER)  # closes the panel


def mutes(obj: bpy.types.Object) -> list[bool]:
    """Those of the bands."""
    return [band.mute for band in obj.data.shape_keys.key_blocks[1:]]
