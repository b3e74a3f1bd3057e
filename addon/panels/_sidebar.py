"""Where the panels are, and how they tell something."""

import textwrap

import bpy

from .. import jobs
from ..operators._job import SPECTRAL_TV_OT_cancel

# Of the region's width in unscaled pixels: what margins, tabs and an icon take, and a character.
TAKEN, CHARACTER = 75, 6.5


class Sidebar:
    """The tab in the 3D view's sidebar."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Spectral TV"


def say(layout: bpy.types.UILayout, context: bpy.types.Context, text: str, icon: str) -> None:
    """Draw a text in as many lines as it needs, as labels cut off what is too long for them."""
    width = context.region.width / context.preferences.system.ui_scale
    column = layout.column(align=True)
    for line in textwrap.wrap(text, max(int((width - TAKEN) / CHARACTER), 10)):
        column.label(text=line, icon=icon)
        icon = "BLANK1"


def draw_progress(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw what the job under way does, how far it is, and a button that cancels it."""
    progress = context.window_manager.spectral_tv.progress
    row = layout.row(align=True)
    row.scale_y = 1.4
    row.progress(text=f"{jobs.running().message} ({progress:.0%})", factor=progress)
    row.operator(SPECTRAL_TV_OT_cancel.bl_idname, text="", icon="CANCEL")
