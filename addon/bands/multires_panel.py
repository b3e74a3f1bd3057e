"""The panel of Multiresolution sculpts and of their work objects."""

import bpy

from ..drawing.sidebar import Sidebar, say
from ..drawing.work import draw_button
from ..scene import multires, work_objects
from .work_object import SPECTRAL_TV_OT_work_object, work_refusal
from .write_back import SPECTRAL_TV_OT_write_back, write_refusal


class SPECTRAL_TV_PT_multires(Sidebar, bpy.types.Panel):
    """From a sculpt to a work object of its top level, and back"""

    bl_label = "Multiresolution"
    bl_parent_id = "SPECTRAL_TV_PT_decompose"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        obj = context.active_object
        if obj is None or obj.type != "MESH":
            return False
        return work_objects.is_work(obj) or multires.modifier_of(obj) is not None

    def rows(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        obj = context.active_object
        if work_objects.is_work(obj):
            reason = write_refusal(obj)
            levels = obj.spectral_tv_work.levels
            text = reason or f"Level {levels} of {obj.spectral_tv_work.source.name}"
            say(layout, context, text, "INFO")
            draw_button(layout, SPECTRAL_TV_OT_write_back, "LOOP_BACK", is_tall=False)
            return
        reason = work_refusal(obj)
        if reason is not None:
            say(layout, context, reason, "INFO")
        draw_button(layout, SPECTRAL_TV_OT_work_object, "MOD_MULTIRES", is_tall=False)
