"""The panel in the Image Editor that filters images."""

import bpy

from ..bands.properties import copy_choices
from ..drawing.work import draw_needs, draw_progress, say
from ..job import estimates, jobs
from .operator import SPECTRAL_TV_OT_filter_image
from .properties import ImageProperties
from .results import source_of
from .sources import refusal


class SPECTRAL_TV_PT_image(bpy.types.Panel):
    """Split the image into bands"""

    bl_space_type = "IMAGE_EDITOR"
    bl_region_type = "UI"
    bl_category = "Spectral TV"
    bl_label = "Filter Image"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        settings = context.scene.spectral_tv_images
        settings.draw_choice(layout)
        image = context.edit_image
        if image is not None and source_of(image) is not None:
            layout.prop(image.spectral_tv, "source")
        if jobs.running() is not None:
            draw_progress(layout, context)
            return
        subject = SPECTRAL_TV_OT_filter_image.subject(context)
        reason = refusal(subject)
        if reason is not None:
            say(layout, context, reason, "INFO")
        else:
            width, height = subject.size
            needs = estimates.of_image(width * height, settings.steps, exact=settings.exact)
            draw_needs(layout, context, needs)
        row = layout.row()
        row.enabled = reason is None
        row.scale_y = 1.4
        operator = row.operator(SPECTRAL_TV_OT_filter_image.bl_idname, icon="IMAGE_DATA")
        copy_choices(ImageProperties, settings, operator)


CLASSES = (SPECTRAL_TV_PT_image,)
