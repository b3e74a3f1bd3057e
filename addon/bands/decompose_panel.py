"""The panel that splits the active mesh, with its sub-panels."""

import bpy

from ..drawing.work import Sidebar, draw_fault, draw_needs, draw_progress, say
from ..job import jobs
from ..scene.objects import refusal, selected_meshes
from . import estimates
from .decompose import SPECTRAL_TV_OT_decompose
from .properties import DecompositionProperties, copy_choices, draw_method, draw_reading
from .settings import WITH_BASE
from .shapes import remarks


class SPECTRAL_TV_PT_decompose(Sidebar, bpy.types.Panel):
    """Choose a method and decompose"""

    bl_label = "Decompose"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.scene.spectral_tv
        column = layout.column()
        column.active = jobs.running() is None
        draw_method(settings, column)
        obj = context.active_object
        if obj is not None and obj.type == "MESH":
            column.prop_search(settings, "vertex_group", obj, "vertex_groups", text="Limit to")
        if jobs.running() is not None:
            draw_progress(layout, context)
            return
        reason = refusal(obj)
        if reason is not None:
            say(layout, context, reason, "INFO")
        elif obj.data.users > 1:
            text = f"{obj.data.users} objects share this mesh; all of them get the bands"
            say(layout, context, text, "INFO")
        draw_fault(layout, context)
        if reason is None:
            for text in remarks(obj, settings.settings()):
                say(layout, context, text[0].upper() + text[1:], "INFO")
            needs = estimates.of_meshes(settings.settings(), len(obj.data.vertices))
            draw_needs(layout, context, needs)
        row = layout.row()
        row.scale_y = 1.4
        operator = row.operator(SPECTRAL_TV_OT_decompose.bl_idname, icon="MOD_MULTIRES")
        copy_choices(DecompositionProperties, settings, operator)
        if reason is None and len(selected_meshes(context)) > 1:
            operator = layout.operator(
                SPECTRAL_TV_OT_decompose.bl_idname, text="Selected as One", icon="MOD_BOOLEAN"
            )
            copy_choices(DecompositionProperties, settings, operator)
            operator.together = True


class SPECTRAL_TV_PT_shape(Sidebar, bpy.types.Panel):
    """Which shape is decomposed, and what of it is joined"""

    bl_label = "Shape"
    bl_parent_id = "SPECTRAL_TV_PT_decompose"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        draw_reading(context.scene.spectral_tv, layout)


class SPECTRAL_TV_PT_scales(Sidebar, bpy.types.Panel):
    """The range of sizes"""

    bl_label = "Scales"
    bl_parent_id = "SPECTRAL_TV_PT_decompose"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.scene.spectral_tv.method != "DISPLACEMENT"

    def draw_header(self, context: bpy.types.Context) -> None:
        self.layout.prop(context.scene.spectral_tv, "use_scales", text="")

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.scene.spectral_tv
        layout.enabled = settings.use_scales
        layout.prop(settings, "shown_finest")
        layout.prop(settings, "shown_largest")


class SPECTRAL_TV_PT_base(Sidebar, bpy.types.Panel):
    """The base from which detail is measured"""

    bl_label = "Base"
    bl_parent_id = "SPECTRAL_TV_PT_decompose"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.scene.spectral_tv.method in WITH_BASE

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.scene.spectral_tv
        layout.prop(settings, "base", text="Shape")
        obj = context.active_object
        if settings.base == "FLOW":
            row = layout.row(heading="Smoothing")
            row.prop(settings, "use_base_amount", text="")
            field = row.row()
            field.enabled = settings.use_base_amount
            field.prop(settings, "shown_base_amount", text="")
        elif settings.base == "KEY" and obj is not None and obj.type == "MESH":
            if obj.data.shape_keys is None:
                say(layout, context, "The mesh has no shape keys", "INFO")
            else:
                layout.prop_search(settings, "base_key", obj.data.shape_keys, "key_blocks")
        if settings.method == "M3":
            layout.prop(settings, "metric")


CLASSES = (
    SPECTRAL_TV_PT_decompose,
    SPECTRAL_TV_PT_shape,
    SPECTRAL_TV_PT_scales,
    SPECTRAL_TV_PT_base,
)
