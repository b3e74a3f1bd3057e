"""The panel that flows attributes, vertex groups, color attributes and shape keys."""

import bpy

from .. import jobs
from ..objects import refusal
from ..operators.attributes import SPECTRAL_TV_OT_flow_attribute
from ._sidebar import Sidebar, draw_progress, say


class SPECTRAL_TV_PT_attributes(Sidebar, bpy.types.Panel):
    """Smooth and filter what is on the surface"""

    bl_label = "Attributes"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.active_object is not None and context.active_object.type == "MESH"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.scene.spectral_tv_attributes
        settings.draw_choice(layout)
        if jobs.running() is not None:
            draw_progress(layout, context)
            return
        reason = refusal(context.active_object)
        if reason is not None:
            say(layout, context, reason, "INFO")
        row = layout.row()
        row.scale_y = 1.4
        operator = row.operator(SPECTRAL_TV_OT_flow_attribute.bl_idname, icon="MOD_SMOOTH")
        settings.copy_to(operator)


CLASSES = (SPECTRAL_TV_PT_attributes,)
