"""What the user chooses of an image's bands, and what an image remembers."""

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    PointerProperty,
    StringProperty,
)

from ..bands.filtering import FilterProperties, SidebarFilter
from .bands import Choice
from .results import SpectralTVImageResult

RESULTS = (
    ("FILTER", "Filtered", "The image with its bands kept, removed or amplified"),
    ("BANDS", "Bands", "Every band as an image, and the rest; they add up to the image"),
)
METRICS = (
    ("FLAT", "Flat", "Along the plane of the image: spectral TV"),
    (
        "SURFACE",
        "Surface",
        "Along the image seen as a relief: adaptive spectral TV, where strong edges stay longer",
    ),
)
CHANNELS = (
    ("ALL", "All", "Red, green and blue together; alpha stays"),
    ("LUMINANCE", "Luminance", "The brightness alone; what it changes is added to all channels"),
)
SIZE = "A spot of this width is gone that stands out by the whole range of the values, and sooner "


class ImageProperties(FilterProperties):
    """How an image is split, and what is written; sizes are in pixels."""

    result: EnumProperty(name="Write", description="What is written", items=RESULTS)
    metric: EnumProperty(name="Distances", description="Along what they are", items=METRICS)
    height: FloatProperty(
        name="Height",
        description="How high the relief is from the darkest to the brightest value",
        subtype="PIXEL",
        default=32,
        min=0.01,
        soft_max=200,
    )
    channels: EnumProperty(name="Channels", description="What is split", items=CHANNELS)
    exact: BoolProperty(
        name="Exact",
        description="Follow Total Variation exactly: spots fade in a straight line until they "
        "are gone. Slower",
        default=False,
    )
    finest: FloatProperty(
        name="Finest",
        description=f"Where the first band ends, about. {SIZE} the less it does",
        subtype="PIXEL",
        default=0.1,
        min=0.001,
        soft_max=10,
        precision=2,
    )
    largest: FloatProperty(
        name="Largest",
        description=f"Where the last band ends. {SIZE} the less it does. What is larger stays in "
        "the rest",
        subtype="PIXEL",
        default=64,
        min=0.01,
        soft_max=1000,
        precision=1,
    )

    def choice(self) -> Choice:
        """The properties as they are."""
        names = Choice.__dataclass_fields__
        return Choice(**{name: getattr(self, name) for name in names})

    def draw_choice(self, layout: bpy.types.UILayout) -> None:
        """Lay out what is chosen, and only what has an effect."""
        column = layout.column()
        column.prop(self, "result")
        column.prop(self, "channels")
        column.prop(self, "metric")
        if self.metric == "SURFACE":
            column.prop(self, "height")
        column = layout.column()
        column.prop(self, "finest")
        column.prop(self, "largest")
        column.prop(self, "bands")
        if self.result == "FILTER":
            self.draw_filter(layout.column())
        column = layout.column()
        column.prop(self, "exact")
        column.prop(self, "steps")


class SpectralTVImages(SidebarFilter, ImageProperties, bpy.types.PropertyGroup):
    """The choices in the Image Editor's sidebar, kept with the scene, and what was written."""

    results: CollectionProperty(type=SpectralTVImageResult)


class SpectralTVImage(bpy.types.PropertyGroup):
    """What an image remembers."""

    source: PointerProperty(
        type=bpy.types.Image,
        name="Source",
        description="What this is a band or a filter of; filtering again starts from there",
    )
    label: StringProperty(name="Label", description="What it is of its source")


CLASSES = (SpectralTVImageResult, SpectralTVImages, SpectralTVImage)
