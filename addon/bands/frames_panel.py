"""The panel of the frames that are filtered."""

import bpy

from .bake_filter import BakeChoices, SPECTRAL_TV_OT_bake_filter
from .bands_panel import BandsPanel


class SpectralTVFrames(BakeChoices, bpy.types.PropertyGroup):
    """How frames are filtered, kept with the scene."""

    owner = bpy.types.Scene, "spectral_tv_frames"


class SPECTRAL_TV_PT_frames(BandsPanel, bpy.types.Panel):
    """The filter of every frame"""

    bl_label = "Frames"
    bl_options = {"DEFAULT_CLOSED"}

    def rows(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        scene, choices = context.scene, context.scene.spectral_tv_frames
        column = layout.column(align=True)
        column.prop(scene, "frame_start", text="Frame Start")
        column.prop(scene, "frame_end", text="End")
        layout.prop(choices, "scales")
        layout.prop(choices, "filepath")
        bake = layout.operator(SPECTRAL_TV_OT_bake_filter.bl_idname, icon="FILE_CACHE")
        bake.frame_start, bake.frame_end = scene.frame_start, scene.frame_end
        bake.scales, bake.filepath = choices.scales, choices.filepath
