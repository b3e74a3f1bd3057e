"""The recipes in the menus Object and Sculpt, where F3 finds them, and the menu of one's own."""

import bpy

from . import own, recipes
from .operator import SPECTRAL_TV_OT_recipe
from .own_operators import (
    SPECTRAL_TV_OT_recipe_export,
    SPECTRAL_TV_OT_recipe_import,
    SPECTRAL_TV_OT_recipe_preset,
)

# Blender's menus that have that of the recipes.
MENUS = ("VIEW3D_MT_object", "VIEW3D_MT_sculpt")


class SPECTRAL_TV_MT_recipes(bpy.types.Menu):
    """Decompose the active object and set its bands in one step"""

    bl_label = "Spectral TV"

    def draw(self, _context: bpy.types.Context) -> None:
        for recipe in recipes.RECIPES:
            button(self.layout, recipe.name, recipe.icon)
        self.layout.separator()
        for _, recipe in own.own():
            button(self.layout, recipe.name, "PRESET")
        self.layout.operator(SPECTRAL_TV_OT_recipe_import.bl_idname, icon="IMPORT")
        self.layout.operator(SPECTRAL_TV_OT_recipe_export.bl_idname, icon="EXPORT")


class SPECTRAL_TV_MT_own_recipes(bpy.types.Menu):
    """Recipes of your own"""

    bl_label = "Own Recipes"

    def draw(self, context: bpy.types.Context) -> None:
        """Draw Blender's menu of presets, of files that are data alone."""
        self.layout.operator(SPECTRAL_TV_OT_recipe_import.bl_idname, icon="IMPORT")
        self.layout.operator(SPECTRAL_TV_OT_recipe_export.bl_idname, icon="EXPORT")
        self.layout.separator()
        chosen = context.scene.spectral_tv_recipe
        names = {str(path): recipe.name for path, recipe in own.own()}
        self.path_menu(
            bpy.utils.preset_paths(own.FOLDER),
            SPECTRAL_TV_OT_recipe.bl_idname,
            prop_filepath="recipe",
            props_default={"strength": chosen.strength, "limit": chosen.limit},
            filter_ext=lambda extension: extension.lower() == own.EXTENSION,
            display_name=lambda path: names.get(path, bpy.path.display_name(path)),
            add_operator=SPECTRAL_TV_OT_recipe_preset.bl_idname,
        )


def button(
    layout: bpy.types.UILayout, name: str, icon: str, strength: float = 1.0, limit: float = 0.0
) -> None:
    """Draw the button of a recipe."""
    operator = layout.operator(SPECTRAL_TV_OT_recipe.bl_idname, text=name, icon=icon)
    operator.recipe = name
    operator.strength, operator.limit = strength, limit


def add() -> None:
    """Show the menu."""
    for name in MENUS:
        getattr(bpy.types, name).append(_draw)


def remove() -> None:
    """Show it no more."""
    for name in MENUS:
        getattr(bpy.types, name).remove(_draw)


def _draw(self: bpy.types.Menu, _context: bpy.types.Context) -> None:
    self.layout.separator()
    self.layout.menu(SPECTRAL_TV_MT_recipes.__name__)
