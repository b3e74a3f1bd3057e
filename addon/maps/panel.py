"""The panel of maps, below that of the bands."""

import bpy

from ..bands.bands_panel import BandsPanel
from ..options import rows
from ..options.properties import give
from .bake_map import MapChoices, SPECTRAL_TV_OT_bake_map


class SpectralTVMaps(MapChoices, bpy.types.PropertyGroup):
    """What is chosen of maps, kept with the scene."""

    owner = bpy.types.Scene, "spectral_tv_maps"


class SPECTRAL_TV_PT_maps(BandsPanel, bpy.types.Panel):
    """The look or a band as a map over UVs"""

    bl_label = "Maps"
    is_split = True

    def rows(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        choices = context.scene.spectral_tv_maps
        rows.draw(layout, choices, *choices.columns)
        layout.prop(choices, "filepath")
        bake = layout.operator(SPECTRAL_TV_OT_bake_map.bl_idname, icon="RENDER_STILL")
        give(choices, bake, SPECTRAL_TV_OT_bake_map)
        bake.filepath = choices.filepath
