"""The place of the panels in the sidebar, and their messages; works without the native module."""

import textwrap

import bpy

# Of the region's width in unscaled pixels: what margins, tabs and an icon take, and a character.
TAKEN, CHARACTER = 75, 6.5


class Sidebar:
    """The tab in the 3D view's sidebar; the preferences may name another one."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Spectral TV"

    # Whether names stand before the fields, as in Blender's own panels.
    is_split = True

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.use_property_split = self.is_split
        self.layout.use_property_decorate = not self.is_split
        self.rows(context, self.layout)

    def rows(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draw what the panel has."""
        raise NotImplementedError


def say(layout: bpy.types.UILayout, context: bpy.types.Context, text: str, icon: str) -> None:
    """Draw a text in as many lines as it needs, as labels cut off what is too long for them."""
    width = context.region.width / context.preferences.system.ui_scale
    column = layout.column(align=True)
    for line in textwrap.wrap(text, max(int((width - TAKEN) / CHARACTER), 10)):
        column.label(text=line, icon=icon)
        icon = "BLANK1"
