"""The choices in the sidebar that are about segments."""

import bpy
from spectral_tv.segmentation.settings import Settings

from ..options.properties import choices_of

SegmentationChoices = choices_of(Settings, "parts outputs")


class SpectralTVSegmentation(SegmentationChoices, bpy.types.PropertyGroup):
    """The choices in the sidebar, kept with the scene."""

    owner = bpy.types.Scene, "spectral_tv_segmentation"
