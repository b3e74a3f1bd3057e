"""The choices in the sidebar that are about attributes, kept with the scene."""

import bpy
from bpy.props import StringProperty

from ..bands.filtering import SidebarFilter
from ..options.properties import choices_of
from .settings import Measure, Settings

# What is flowed, of what sizes, the filter, how.
COLUMNS = ("source", "sizes bands", "filter", "law steps")
AttributeChoices, MeasureChoices = choices_of(Settings, *COLUMNS), choices_of(Measure, *COLUMNS)


class SpectralTVAttributes(SidebarFilter, MeasureChoices, bpy.types.PropertyGroup):
    """What is flowed, and what is told of it."""

    owner = bpy.types.Scene, "spectral_tv_attributes"

    group: StringProperty(
        name="Set", description="The vertex group to test; the active one if left empty"
    )
