"""What is chosen in the sidebar about the deviation, kept with the scene."""

import bpy
from bpy.props import FloatProperty
from spectral_tv.bands.limits import LimitSettings

from ..options.properties import choices_of


class SpectralTVDeviation(choices_of(LimitSettings, "limit"), bpy.types.PropertyGroup):
    """A limit, and what the ends of the colors stand for."""

    owner = bpy.types.Scene, "spectral_tv_deviation"

    range: FloatProperty(
        name="Range",
        description="The deviation that has the strongest colors; 0 is the largest that there is",
        subtype="DISTANCE",
        min=0,
        precision=4,
    )
