"""The ranges of the bands' sliders: short at first, wider where that is asked for."""

import math
from collections.abc import Sequence

import bpy

from ..scene import keeping, shape_keys
from ..scene.records import bands_of
from .set_bands import BandsOperator


class SPECTRAL_TV_OT_widen_sliders(BandsOperator, bpy.types.Operator):
    """Have the sliders go from −10 to 10; again, from −1 to 2 or as far as their values are"""

    bl_idname = "spectral_tv.widen_sliders"
    bl_label = "Widen Sliders"

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> None:
        bands = [band for band in bands_of(obj) if band is not None]
        wide = not is_wide(bands)
        for band in bands:
            least, most = shape_keys.SLIDER_RANGE if wide else shape_keys.USUAL_RANGE
            band.slider_min = min(least, math.floor(band.value))
            band.slider_max = max(most, math.ceil(band.value))


def is_wide(bands: "Sequence[keeping.Band]") -> bool:
    """Whether all sliders go as far as Blender allows."""
    return all((band.slider_min, band.slider_max) == shape_keys.SLIDER_RANGE for band in bands)


def draw_scale(
    layout: bpy.types.UILayout, bands: "Sequence[keeping.Band | None]", icons: int
) -> None:
    """Draw the ends and zero above sliders that have the same range, and a button that widens it.

    The sliders have a sign before them and so many ``icons`` after them.
    """
    there = [band for band in bands if band is not None]
    ranges = {(band.slider_min, band.slider_max) for band in there}
    row = layout.row(align=True)
    row.label(text="", icon="BLANK1")
    least, most = ranges.pop() if len(ranges) == 1 else (0.0, 0.0)
    if least < 0 < most:
        split = row.split(factor=-least / (most - least), align=True)
        split.label(text=_written(least))
        right = split.row(align=True)
        right.label(text="0")
        end = right.row(align=True)
        end.alignment = "RIGHT"
        end.label(text=_written(most))
    else:
        row.label(text="")
    for _ in range(icons - 1):
        row.label(text="", icon="BLANK1")
    row.operator(
        SPECTRAL_TV_OT_widen_sliders.bl_idname,
        text="",
        icon="FULLSCREEN_EXIT" if is_wide(there) else "FULLSCREEN_ENTER",
    )


def _written(end: float) -> str:
    return f"{end:.3g}".replace("-", "−")
