"""The panel that flows attributes, vertex groups, color attributes and shape keys."""

import bpy

from ..bands.properties import copy_choices
from ..drawing.work import Sidebar, draw_needs, draw_progress, say
from ..job import estimates, jobs
from ..scene.objects import is_mesh, refusal
from .eigenset import SPECTRAL_TV_OT_test_eigenset
from .flow import SPECTRAL_TV_OT_flow_attribute
from .properties import AttributeProperties, MeasureProperties
from .values import SPECTRAL_TV_OT_export_values, SPECTRAL_TV_OT_plot_values


class SPECTRAL_TV_PT_attributes(Sidebar, bpy.types.Panel):
    """Smooth and filter what is on the surface"""

    bl_label = "Attributes"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = 4

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return is_mesh(context.active_object)

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
        count = len(context.active_object.data.vertices)
        is_exact = settings.exact and settings.law == "TV"
        draw_needs(layout, context, estimates.of_values(count, settings.steps, exact=is_exact))
        row = layout.row()
        row.scale_y = 1.4
        operator = row.operator(SPECTRAL_TV_OT_flow_attribute.bl_idname, icon="MOD_SMOOTH")
        copy_choices(AttributeProperties, settings, operator)


class SPECTRAL_TV_PT_values(Sidebar, bpy.types.Panel):
    """How values fall while they flow"""

    bl_label = "Values over Time"
    bl_parent_id = "SPECTRAL_TV_PT_attributes"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.scene.spectral_tv_attributes
        layout.prop(settings, "size")
        layout.prop(settings, "parts")
        row = layout.row()
        row.active = settings.parts == "GROUPS"
        row.prop(settings, "groups")
        row = layout.row(align=True)
        operator = row.operator(SPECTRAL_TV_OT_plot_values.bl_idname, icon="FCURVE")
        copy_choices(AttributeProperties, settings, operator)
        copy_choices(MeasureProperties, settings, operator)
        row.operator(SPECTRAL_TV_OT_export_values.bl_idname, icon="EXPORT")
        picture = context.active_object.data.spectral_tv.picture
        if picture is not None and picture.preview is not None:
            layout.template_icon(picture.preview.icon_id, scale=9)
            layout.label(text=picture.name, icon="IMAGE_DATA")


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


CLASSES = (SPECTRAL_TV_PT_attributes, SPECTRAL_TV_PT_values, SPECTRAL_TV_PT_eigenset)
