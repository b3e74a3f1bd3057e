"""The panel of the recipes, the first of the tab."""

import bpy

from ..drawing.sidebar import say
from ..drawing.work import WorkPanel, draw_fault
from ..scene.objects import refusal, selected_meshes
from . import recipes
from .menu import SPECTRAL_TV_MT_own_recipes, button


class SPECTRAL_TV_PT_recipes(WorkPanel, bpy.types.Panel):
    """A look in one step"""

    bl_label = "Recipes"
    is_split = False

    def draw_header_preset(self, _context: bpy.types.Context) -> None:
        self.layout.menu(SPECTRAL_TV_MT_own_recipes.__name__, text="", icon="PRESET")

    def choices(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        layout.prop(context.scene.spectral_tv_recipe, "strength", slider=True)
        layout.prop(context.scene.spectral_tv_recipe, "limit")

    def actions(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        chosen = context.scene.spectral_tv_recipe
        reason = refusal(context.active_object)
        if reason is not None:
            say(layout, context, reason, "INFO")
        elif len(selected_meshes(context)) > 1:
            say(layout, context, f"Of {context.active_object.name} alone", "INFO")
        draw_fault(layout, context)
        grid = layout.grid_flow(columns=2, row_major=True, align=True, even_columns=True)
        for recipe in recipes.RECIPES:
            button(grid, recipe.name, "NONE", chosen.strength, chosen.limit)
