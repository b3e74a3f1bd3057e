"""The panel in the Image Editor that filters images."""

import bpy
from spectral_tv.options.estimates import of_values

from ..drawing.sidebar import say
from ..drawing.work import WorkPanel, draw_button, draw_needs
from . import results
from .operator import SPECTRAL_TV_OT_filter_image
from .sources import refusal


class SPECTRAL_TV_PT_image(WorkPanel, bpy.types.Panel):
    """Split the image into bands"""

    bl_space_type = "IMAGE_EDITOR"
    bl_label = "Filter Image"
    kept = "spectral_tv_images"

    def choices(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        super().choices(context, layout)
        image = context.edit_image
        if image is not None and results.source_of(image) is not None:
            layout.prop(image.spectral_tv, "source")

    def actions(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        choices = context.scene.spectral_tv_images
        subject = SPECTRAL_TV_OT_filter_image.subject(context)
        reason = refusal(subject)
        if reason is not None:
            say(layout, context, reason, "INFO")
        else:
            width, height = subject.size
            smaller, how = "a smaller image", (choices.steps, choices.exact)
            draw_needs(layout, context, of_values(width * height, *how, smaller=smaller))
        row = layout.row()
        row.enabled = reason is None
        draw_button(row, SPECTRAL_TV_OT_filter_image, "IMAGE_DATA", choices)
