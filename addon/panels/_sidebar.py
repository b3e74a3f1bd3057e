"""What the panels share."""

import bpy

from .. import jobs
from ..operators._job import SPECTRAL_TV_OT_cancel
from ..sidebar import Sidebar, say

__all__ = ["Sidebar", "draw_progress", "say"]


def draw_progress(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw what the job under way does, how far it is, and a button that cancels it."""
    progress = context.window_manager.spectral_tv.progress
    row = layout.row(align=True)
    row.scale_y = 1.4
    row.progress(text=f"{jobs.running().message} ({progress:.0%})", factor=progress)
    row.operator(SPECTRAL_TV_OT_cancel.bl_idname, text="", icon="CANCEL")
