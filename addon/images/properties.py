"""The choices about images in the sidebar, and what an image remembers."""

import bpy
from bpy.props import CollectionProperty, PointerProperty, StringProperty
from spectral_tv.images.settings import Settings

from ..bands.filtering import SidebarFilter
from ..options.properties import choices_of
from ..scene.documents import SpectralTVDocument

# What is split, in what sizes, the filter, how.
ImageChoices = choices_of(Settings, "what", "sizes bands", "filter", "exact steps")


class SpectralTVImages(SidebarFilter, ImageChoices, bpy.types.PropertyGroup):
    """The choices in the Image Editor's sidebar, kept with the scene, and what was written."""

    owner = bpy.types.Scene, "spectral_tv_images"

    results: CollectionProperty(type=SpectralTVDocument)


class SpectralTVImage(bpy.types.PropertyGroup):
    """What an image remembers."""

    owner = bpy.types.Image, "spectral_tv"

    source: PointerProperty(
        type=bpy.types.Image, name="Source",
        description="What this is a band or a filter of; filtering again starts from there"
    )  # fmt: skip
    label: StringProperty(name="Label", description="What it is of its source")
