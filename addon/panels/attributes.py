"""The panel that flows attributes, vertex groups, color attributes and shape keys."""

import bpy

from .. import jobs
from ..objects import refusal
from ..operators.attributes import SPECTRAL_TV_OT_flow_attribute
from ..operators.eigenset import SPECTRAL_TV_OT_test_eigenset
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


class SPECTRAL_TV_PT_eigenset(Sidebar, bpy.types.Panel):
    """Whether a vertex group fades as a whole"""

    bl_label = "Eigenset Test"
    bl_parent_id = "SPECTRAL_TV_PT_attributes"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.scene.spectral_tv_attributes
        layout.prop_search(settings, "group", context.active_object, "vertex_groups")
        operator = layout.operator(SPECTRAL_TV_OT_test_eigenset.bl_idname, icon="VIEWZOOM")
        operator.group = settings.group


CLASSES = (SPECTRAL_TV_PT_attributes, SPECTRAL_TV_PT_eigenset)
