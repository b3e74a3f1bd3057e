"""The strength and the limit in the sidebar, kept with the scene."""

import bpy

from ..options.properties import choices_of, property_of
from .settings import RecipeSettings

RecipeChoices = choices_of(RecipeSettings, "strength")


class SpectralTVRecipe(bpy.types.PropertyGroup):
    """How strong the recipes of the sidebar are, and how far they move."""

    owner = bpy.types.Scene, "spectral_tv_recipe"

    strength: property_of(RecipeSettings, "strength")
    limit: property_of(RecipeSettings, "limit")
