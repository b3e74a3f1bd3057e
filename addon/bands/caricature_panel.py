"""The panel that exaggerates the selected meshes alike."""

from functools import partial

import bpy

from ..drawing.work import Sidebar, draw_progress, draw_selection
from ..job import jobs
from ..scene.objects import is_mesh
from .caricature import SPECTRAL_TV_OT_caricature
from .estimates import of_meshes
from .properties import CaricatureProperties, copy_choices
from .settings import Settings


class SPECTRAL_TV_PT_caricature(Sidebar, bpy.types.Panel):
    """One exaggeration for many poses"""

    bl_label = "Caricature"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = 2

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return is_mesh(context.active_object)

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.scene.spectral_tv_caricature
        column = layout.column()
        for name in ("method", "bands", "steps"):
            column.prop(settings, name)
        column = layout.column(align=True)
        column.prop(settings, "first")
        column.prop(settings, "last")
        column = layout.column()
        column.prop(settings, "amount")
        column.prop(settings, "smooth")
        if jobs.running() is not None:
            draw_progress(layout, context)
            return
        chosen = Settings(method=settings.method, steps=settings.steps)
        draw_selection(layout, context, "filter", partial(of_meshes, chosen))
        row = layout.row()
        row.scale_y = 1.4
        operator = row.operator(SPECTRAL_TV_OT_caricature.bl_idname, icon="OUTLINER_OB_ARMATURE")
        copy_choices(CaricatureProperties, settings, operator)


CLASSES = (SPECTRAL_TV_PT_caricature,)
