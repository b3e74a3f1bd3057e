"""The panel that tells how accurate bands are."""

from itertools import chain

import bpy

from ..bands import estimates
from ..bands.bands import settings_as_taken
from ..bands.bands_panel import BandsPanel
from ..bands.settings import STEPLESS
from ..drawing.work import draw_needs, draw_progress
from ..job import jobs
from ..scene.records import record_of
from . import accuracy
from .measure_accuracy import SPECTRAL_TV_OT_measure_accuracy


class SPECTRAL_TV_PT_accuracy(BandsPanel, bpy.types.Panel):
    """How accurate the bands are for the number of steps"""

    bl_label = "Accuracy"
    bl_parent_id = "SPECTRAL_TV_PT_bands"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        obj = context.active_object
        return super().poll(context) and record_of(obj).method not in STEPLESS

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        obj = context.active_object
        record = record_of(obj)
        settings = settings_as_taken(record)
        if jobs.running() is not None:
            draw_progress(layout, context)
            return
        count = len(obj.data.vertices)
        layout.label(text=f"{settings.steps} steps, a half and a quarter of them", icon="BLANK1")
        draw_needs(layout, context, estimates.of_accuracy(record.method, count, settings.steps))
        operator = layout.operator(
            SPECTRAL_TV_OT_measure_accuracy.bl_idname, icon="DRIVER_DISTANCE"
        )
        operator.of_bands = True
        text = obj.data.spectral_tv.accuracy
        if text is None:
            return
        grid = layout.grid_flow(columns=3, row_major=True, align=True, even_columns=True)
        for cell in chain.from_iterable(accuracy.summary(text.as_string())):
            grid.label(text=cell)
        layout.label(text=text.name, icon="TEXT")


CLASSES = (SPECTRAL_TV_PT_accuracy,)
