"""The panel that labels the parts of the selected meshes."""

import bpy
from spectral_tv.bands.settings import Settings
from spectral_tv.segmentation.settings import METHOD

from ..drawing.work import MeshPanel, draw_button, draw_selection
from ..scene.results import SEGMENTS, groups_shown
from .cosegment import SPECTRAL_TV_OT_cosegment
from .split_segments import SPECTRAL_TV_OT_split_segments


class SPECTRAL_TV_PT_segment(MeshPanel, bpy.types.Panel):
    """Find the same parts in several poses"""

    bl_label = "Segment"
    bl_order = 3
    kept = "spectral_tv_segmentation"

    def actions(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        choices = context.scene.spectral_tv_segmentation
        settings = Settings(method=METHOD.upper(), steps=choices.steps)
        draw_selection(layout, context, "parts", settings.needs)
        draw_button(layout, SPECTRAL_TV_OT_cosegment, "COLOR", choices)
        if groups_shown(context.active_object, SEGMENTS):
            layout.operator(SPECTRAL_TV_OT_split_segments.bl_idname, icon="UV_ISLANDSEL")
