"""The panel that labels the parts of the selected meshes."""

from functools import partial

import bpy

from ..bands.estimates import of_meshes
from ..bands.properties import copy_choices
from ..bands.settings import Settings
from ..drawing.work import Sidebar, draw_progress, draw_selection
from ..job import jobs
from ..scene.objects import is_mesh
from .cosegment import METHOD, SPECTRAL_TV_OT_cosegment
from .properties import SegmentationProperties


class SPECTRAL_TV_PT_segment(Sidebar, bpy.types.Panel):
    """Find the same parts in several poses"""

    bl_label = "Segment"
    bl_options = {"DEFAULT_CLOSED"}
    bl_order = 3

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return is_mesh(context.active_object)

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.scene.spectral_tv_segmentation
        column = layout.column()
        column.prop(settings, "segments")
        column.prop(settings, "steps")
        column.column(align=True).prop(settings, "outputs")
        if jobs.running() is not None:
            draw_progress(layout, context)
            return
        chosen = Settings(method=METHOD.upper(), steps=settings.steps)
        draw_selection(layout, context, "parts", partial(of_meshes, chosen))
        row = layout.row()
        row.scale_y = 1.4
        operator = row.operator(SPECTRAL_TV_OT_cosegment.bl_idname, icon="COLOR")
        copy_choices(SegmentationProperties, settings, operator)


CLASSES = (SPECTRAL_TV_PT_segment,)
