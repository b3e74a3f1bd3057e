"""The panel in the Image Editor that filters images."""

import bpy

from ..drawing.sidebar import say
from ..drawing.work import WorkPanel, draw_button, draw_needs
from ..job import estimates
from ..options import rows
from .operator import SPECTRAL_TV_OT_filter_image
from .results import source_of
from .sources import refusal


class SPECTRAL_TV_PT_image(WorkPanel, bpy.types.Panel):
    """Split the image into bands"""

    bl_space_type = "IMAGE_EDITOR"
    bl_label = "Filter Image"

    def choices(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        choices = context.scene.spectral_tv_images
        rows.draw(layout, choices, *choices.columns)
        image = context.edit_image
        if image is not None and source_of(image) is not None:
            layout.prop(image.spectral_tv, "source")

    def actions(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        choices = context.scene.spectral_tv_images
        subject = SPECTRAL_TV_OT_filter_image.subject(context)
        reason = refusal(subject)
        if reason is not None:
            say(layout, context, reason, "INFO")
        else:
            width, height = subject.size
            needs = estimates.of_image(width * height, choices.steps, exact=choices.exact)
            draw_needs(layout, context, needs)
        row = layout.row()
        row.enabled = reason is None
        draw_button(row, SPECTRAL_TV_OT_filter_image, "IMAGE_DATA", choices)
