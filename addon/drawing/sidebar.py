"""Where the panels are, and how they tell something; needs nothing of the native module."""

import textwrap

import bpy

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
