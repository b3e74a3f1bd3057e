"""What the user chooses of a segmentation."""

import bpy
from bpy.props import EnumProperty, IntProperty

from .segments import OUTPUTS


class SegmentationProperties:
    """What the user chooses of a segmentation."""

    segments: IntProperty(name="Segments", description="Number of parts", default=6, min=1, max=64)
    steps: IntProperty(
        name="Steps",
        description="Number of time steps of the flow. More steps find the same parts in more "
        "different poses",
        default=48,
        min=4,
        max=1000,
    )
    seed: IntProperty(name="Seed", description="Of the random starts", default=0, min=0)
    outputs: EnumProperty(
        name="Write",
        description="How the parts are written",
        items=OUTPUTS,
        options={"ENUM_FLAG"},
        default={"COLOR", "GROUPS"},
    )


class SpectralTVSegmentation(SegmentationProperties, bpy.types.PropertyGroup):
    """The choices in the sidebar, kept with the scene."""


CLASSES = (SpectralTVSegmentation,)
