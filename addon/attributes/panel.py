"""The panel that flows attributes, vertex groups, color attributes and shape keys."""

import bpy
from spectral_tv.options.estimates import of_values

from ..drawing.preferences import shows_research
from ..drawing.sidebar import Sidebar, say
from ..drawing.work import MeshPanel, draw_button, draw_needs
from ..options import rows
from ..scene.objects import refusal
from .eigenset import SPECTRAL_TV_OT_test_eigenset
from .flow import SPECTRAL_TV_OT_flow_attribute
from .thickness import SPECTRAL_TV_OT_measure_thickness
from .values import SPECTRAL_TV_OT_export_values, SPECTRAL_TV_OT_plot_values


class SPECTRAL_TV_PT_attributes(MeshPanel, bpy.types.Panel):
    """Smooth and filter what is on the surface"""

    bl_label = "Attributes"
    bl_order = 4
    kept = "spectral_tv_attributes"

    def actions(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        choices = context.scene.spectral_tv_attributes
        reason = refusal(context.active_object)
        if reason is not None:
            say(layout, context, reason, "INFO")
        count, settings = len(context.active_object.data.vertices), choices.settings()
        draw_needs(layout, context, of_values(count, settings.steps, settings.is_exact))
        draw_button(layout, SPECTRAL_TV_OT_flow_attribute, "MOD_SMOOTH", choices)
        layout.operator(SPECTRAL_TV_OT_measure_thickness.bl_idname, icon="MOD_THICKNESS")


class AttributesPart(Sidebar):
    """A sub-panel of it."""

    bl_parent_id = "SPECTRAL_TV_PT_attributes"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        return shows_research()


class SPECTRAL_TV_PT_values(AttributesPart, bpy.types.Panel):
    """How values fall while they flow"""

    bl_label = "Values over Time"

    def rows(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        choices = context.scene.spectral_tv_attributes
        layout.prop(choices, "size")
        rows.draw(layout, choices, "parts")
        row = layout.row(align=True)
        draw_button(row, SPECTRAL_TV_OT_plot_values, "FCURVE", choices, is_tall=False)
        row.operator(SPECTRAL_TV_OT_export_values.bl_idname, icon="EXPORT")
        picture = context.active_object.data.spectral_tv.picture
        if picture is not None and picture.preview is not None:
            layout.template_icon(picture.preview.icon_id, scale=9)
            layout.label(text=picture.name, icon="IMAGE_DATA")


class SPECTRAL_TV_PT_eigenset(AttributesPart, bpy.types.Panel):
    """Whether a vertex group fades as a whole"""

    bl_label = "Eigenset Test"

    def rows(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        choices = context.scene.spectral_tv_attributes
        layout.prop_search(choices, "group", context.active_object, "vertex_groups")
        layout.prop(choices, "elements")
        operator = layout.operator(SPECTRAL_TV_OT_test_eigenset.bl_idname, icon="VIEWZOOM")
        operator.group, operator.elements = choices.group, choices.elements
