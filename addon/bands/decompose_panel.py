"""The panel that splits the active mesh, with its sub-panels."""

import bpy
from spectral_tv.bands.settings import INTO

from ..drawing.sidebar import Sidebar, say
from ..drawing.work import TALL, WorkPanel, draw_button, draw_fault, draw_needs
from ..job import jobs
from ..options import rows
from ..scene.decomposition import SpectralTVRecord
from ..scene.modifiers import between
from ..scene.objects import is_mesh, refusal, selected_meshes
from ..scene.records import bands_shown, record_of
from . import at_once, replacing, shapes
from .bands import place_refusal
from .decompose import SPECTRAL_TV_OT_decompose
from .take_bands import take_all


class SPECTRAL_TV_PT_decompose(WorkPanel, bpy.types.Panel):
    """Choose a method and decompose"""

    bl_label = "Decompose"

    def rows(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        WorkPanel.rows(self, context, layout)
        at_once.draw(layout, context)

    def choices(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        column = layout.column()
        column.active = jobs.running() is None or at_once.is_active()
        rows.draw(column, context.scene.spectral_tv, "method mask", obj=context.active_object)

    def actions(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        obj, choices = context.active_object, context.scene.spectral_tv
        reason = refusal(obj)
        if reason is not None:
            say(layout, context, reason, "INFO")
        elif obj.data.users > 1:
            text = f"{obj.data.users} objects share this mesh; all of them get the bands"
            say(layout, context, text, "INFO")
        draw_fault(layout, context)
        if reason is None:
            settings = choices.settings()
            former = replacing.replaced(obj, settings)
            bands = () if former is None else bands_shown(obj, former)
            for text in shapes.remarks(obj, settings, [key for key in bands if key is not None]):
                say(layout, context, text[0].upper() + text[1:], "INFO")
            text = place_refusal(obj, settings)
            if text is not None:
                say(layout, context, text, "ERROR")
            draw_needs(layout, context, settings.needs(shapes.vertex_count(obj, settings)))
            draw_into(layout, context, former)
        row = layout.row(align=True)
        draw_button(row, SPECTRAL_TV_OT_decompose, "MOD_MULTIRES", choices)
        switch = row.row()
        switch.scale_y = TALL
        switch.prop(choices, "at_once", text="", icon="FILE_REFRESH")
        if reason is None and len(selected_meshes(context)) > 1:
            together = draw_button(
                layout,
                SPECTRAL_TV_OT_decompose,
                "MOD_BOOLEAN",
                choices,
                is_tall=False,
                text="Selected as One",
            )
            together.together = True
        if reason is None and record_of(obj) is None and _has_bands_beside(context):
            take_all(layout, icon="IMPORT")


def _has_bands_beside(context: bpy.types.Context) -> bool:
    """Whether one other object is selected, and has bands."""
    others = [obj for obj in context.selected_objects if obj != context.active_object]
    return len(others) == 1 and record_of(others[0]) is not None


def draw_into(
    layout: bpy.types.UILayout, context: bpy.types.Context, former: SpectralTVRecord | None
) -> None:
    """Draw what becomes of the bands that there are, if there are any; those of ``former`` are
    replaced.
    """
    obj, choices = context.active_object, context.scene.spectral_tv
    active = record_of(obj)
    if active is None:
        return
    row = layout.row(align=True)
    row.use_property_split = False
    for value, *_ in INTO:
        row.prop_enum(choices, "into", value)
    if former is not None:
        say(layout, context, f"Replaces {former.name}; look kept", "INFO")
    elif choices.into == "REPLACE":
        reason = replacing.why_not(obj, choices.settings())
        say(layout, context, f"Added, as {active.name} is {reason}", "INFO")


class PartPanel(Sidebar):
    """Options that have a sub-panel of their own, where one of them has an effect."""

    bl_parent_id = "SPECTRAL_TV_PT_decompose"
    bl_options = {"DEFAULT_CLOSED"}
    place: str

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return rows.is_shown(context.scene.spectral_tv, cls.place)

    def rows(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        rows.draw(layout, context.scene.spectral_tv, self.place, obj=context.active_object)


class SPECTRAL_TV_PT_shape(PartPanel, bpy.types.Panel):
    """Which shape is decomposed, and what of it is joined"""

    bl_label = "Shape"
    place = "shape"

    def rows(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        super().rows(context, layout)
        obj = context.active_object
        names = between(obj) if is_mesh(obj) else []
        if names:
            say(layout, context, f"Shown with {', '.join(names)}", "MODIFIER")


class SPECTRAL_TV_PT_scales(PartPanel, bpy.types.Panel):
    """The range of sizes"""

    bl_label = "Scales"
    place = "scales"

    def draw_header(self, context: bpy.types.Context) -> None:
        self.layout.prop(context.scene.spectral_tv, "use_scales", text="")

    def rows(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        layout.enabled = context.scene.spectral_tv.use_scales
        super().rows(context, layout)


class SPECTRAL_TV_PT_base(PartPanel, bpy.types.Panel):
    """The base from which detail is measured"""

    bl_label = "Base"
    place = "base"
