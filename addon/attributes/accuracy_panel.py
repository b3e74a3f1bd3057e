"""The panel that tells how accurate bands are."""

from itertools import chain

import bpy
from spectral_tv.attributes.accuracy import needs, summary
from spectral_tv.bands.methods import METHODS

from ..bands.bands import settings_as_taken
from ..bands.bands_panel import BandsPanel
from ..drawing.preferences import shows_research
from ..drawing.work import WorkPanel, draw_button, draw_needs
from ..scene.records import record_of
from .measure_accuracy import SPECTRAL_TV_OT_measure_accuracy


class SPECTRAL_TV_PT_accuracy(BandsPanel, WorkPanel, bpy.types.Panel):
    """How accurate the bands are for the number of steps"""

    bl_label = "Accuracy"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        obj = context.active_object
        return (
            shows_research()
            and super().poll(context)
            and METHODS[record_of(obj).method].takes_steps
        )

    def actions(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        obj = context.active_object
        settings = settings_as_taken(record_of(obj))
        count = len(obj.data.vertices)
        layout.label(text=f"{settings.steps} steps, a half and a quarter of them", icon="BLANK1")
        draw_needs(layout, context, needs(settings.method, count, settings.steps))
        button = draw_button(
            layout, SPECTRAL_TV_OT_measure_accuracy, "DRIVER_DISTANCE", is_tall=False
        )
        button.of_bands = True
        text = obj.data.spectral_tv.accuracy
        if text is None:
            return
        grid = layout.grid_flow(columns=3, row_major=True, align=True, even_columns=True)
        for cell in chain.from_iterable(summary(text.as_string())):
            grid.label(text=cell)
        layout.label(text=text.name, icon="TEXT")
