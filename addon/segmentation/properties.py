"""The choices in the sidebar that are about segments."""

from dataclasses import dataclass

import bpy
from spectral_tv.options.declaring import integer, several

from ..options.properties import choices_of
from .segments import OUTPUTS


@dataclass(frozen=True)
class Settings:
    """How many parts are found by what, and how they are written."""

    segments: int = integer("Segments", "Number of parts", 6, 1, 64, place="parts")
    steps: int = integer(
        "Steps",
        "Number of time steps of the flow. More steps find the same parts in more different poses",
        48, 4, 1000, place="parts"
    )  # fmt: skip
    seed: int = integer("Seed", "Of the random starts", 0, 0, None, place="seed")
    outputs: frozenset[str] = several(
        "Write", "How the parts are written", OUTPUTS, ("COLOR", "GROUPS"), place="outputs"
    )


SegmentationChoices = choices_of(Settings, "parts outputs")


class SpectralTVSegmentation(SegmentationChoices, bpy.types.PropertyGroup):
    """The choices in the sidebar, kept with the scene."""

    owner = bpy.types.Scene, "spectral_tv_segmentation"
