"""The panel of the deviation, below that of the bands."""

import bpy

from ..bands.bands_panel import BandsPanel
from ..drawing.sidebar import say
from . import heat_map
from .limit_movement import SPECTRAL_TV_OT_limit_movement, limit_in_force
from .measure import SPECTRAL_TV_OT_measure_deviation


class SPECTRAL_TV_PT_deviation(BandsPanel, bpy.types.Panel):
    """How far the bands move the surface"""

    bl_label = "Deviation"

    def rows(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        obj, chosen = context.active_object, context.scene.spectral_tv_deviation
        layout.prop(chosen, "limit", text="Limit")
        held = limit_in_force(obj)
        row = layout.row(align=True)
        part = row.row(align=True)
        part.enabled = chosen.limit > 0
        button = part.operator(SPECTRAL_TV_OT_limit_movement.bl_idname, icon="CON_DISTLIMIT")
        button.limit = chosen.limit
        if held:
            row.operator(SPECTRAL_TV_OT_limit_movement.bl_idname, text="", icon="X").limit = 0
            say(layout, context, f"Held within {held}, at the values then", "INFO")
        layout.prop(obj.data.spectral_tv, "shows_deviation", toggle=True, icon="COLOR")
        if obj.data.spectral_tv.shows_deviation:
            text = heat_map.hidden(context)
            if text:
                say(layout, context, text, "INFO")
            layout.prop(chosen, "range")
        measure = layout.operator(SPECTRAL_TV_OT_measure_deviation.bl_idname, icon="FILE_TEXT")
        measure.limit = chosen.limit
        kept = obj.data.spectral_tv.deviation
        if kept is not None:
            layout.label(text=kept.name, icon="TEXT")
