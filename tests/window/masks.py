"""The brush beside a band and its menu, used by mouse and keys."""

from __future__ import annotations

import bpy
import numpy as np
from pictures import away
from screen import (
    Steps,
    centre,
    click,
    drag,
    find,
    in_view,
    key,
    picture,
    region,
    until,
    xdotool,
)

BAND = 4
BRUSH, COLUMN = f"spectral_tv.paint_mask(band={BAND})", 0.62
# From the brush of a band to the arrow of its menu.
NEXT_BUTTON = 20


def masks() -> Steps[None]:
    """Mask a band of the active object by a stroke, go back, invert the mask, and undo that."""
    yield from click(*(yield from find(BRUSH, COLUMN)))
    yield from until(lambda: bpy.context.object.mode == "WEIGHT_PAINT", "Weight Paint")
    assert weights().min() == 1
    have_a_brush()
    xdotool("keydown", "ctrl")  # which paints 0 where the brush has 1
    yield from drag(*centre(region("WINDOW")), 100)
    xdotool("keyup", "ctrl")
    yield from until(lambda: weights().min() < 0.1, "the stroke to be in the mask")
    yield from away()
    yield from picture("mask_painted")
    yield from click(*(yield from find(BRUSH, COLUMN)))
    yield from until(lambda: bpy.context.object.mode == "OBJECT", "Object Mode")
    painted = weights()
    x, y = yield from find(BRUSH, COLUMN)
    yield from click(x + NEXT_BUTTON, y)
    yield from picture("mask_menu")
    yield from key("i")
    yield from until(lambda: np.allclose(weights(), 1 - painted, atol=1e-5), "the inverted mask")
    yield from key("ctrl+z")
    yield from until(lambda: np.array_equal(weights(), painted), "undo of that")


def have_a_brush() -> None:
    """Have Weight Paint have a brush: Debian's Blender comes without Blender's own ones."""
    if bpy.context.scene.tool_settings.weight_paint.brush is None:
        bpy.data.brushes.new("Draw", mode="WEIGHT_PAINT").asset_mark()
        with in_view():
            bpy.ops.brush.asset_activate(
                asset_library_type="LOCAL", relative_asset_identifier="Brush/Draw"
            )


def weights() -> np.ndarray:
    """Those of the mask."""
    obj = bpy.context.object
    name = obj.data.shape_keys.key_blocks[BAND].vertex_group
    index = obj.vertex_groups[name].index
    found = [[each.weight for each in v.groups if each.group == index] for v in obj.data.vertices]
    return np.array([sum(each) for each in found])
