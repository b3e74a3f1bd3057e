"""What the user chooses of a flow on an attribute, shared by the sidebar and the operators."""

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    StringProperty,
)

from ..bands.filtering import FilterProperties, SidebarFilter
from .curves import PARTS
from .flows import Choice
from .sources import KINDS, names

RESULTS = (
    ("FLOW", "Smoothed", "The values, flowed until spots of the chosen size are gone"),
    ("FILTER", "Filtered", "The values with their bands kept, removed or amplified"),
    ("BANDS", "Bands", "Every band of the values, and the rest; they add up to the values"),
)
LAWS = (
    ("TV", "Total Variation", "Edges stay crisp: every spot keeps its outline until it is gone"),
    ("HEAT", "Heat", "Linear diffusion, which blurs edges; for comparison"),
)
SIZE = "relative to the object's size. A round spot of this width is gone"


def _names(self: "AttributeProperties", context: bpy.types.Context, _text: str) -> list[str]:
    obj = context.active_object
    return names(obj, self.kind) if obj is not None and obj.type == "MESH" else []


class AttributeProperties(FilterProperties):
    """What is flowed, how, and what of it is written; sizes are percentages of √ of the area."""

    kind: EnumProperty(name="Flow", description="What is flowed", items=KINDS)
    source: StringProperty(
        name="Name", description="Which one; the active one if left empty", search=_names
    )
    result: EnumProperty(name="Write", description="What is written", items=RESULTS)
    law: EnumProperty(name="By", description="How the values flow", items=LAWS)
    exact: BoolProperty(
        name="Exact",
        description="Follow Total Variation exactly: spots fade in a straight line until they "
        "are gone. Otherwise faster, and faint remains may stay",
        default=True,
    )
    size: FloatProperty(
        name="Size",
        description=f"How far to flow, {SIZE}: with Total Variation if it stands out by the whole "
        "range of the values, and sooner the less it does",
        subtype="PERCENTAGE",
        default=10,
        min=0.01,
        soft_max=100,
        max=1000,
        precision=2,
    )
    finest: FloatProperty(
        name="Finest",
        description=f"Where the first band ends, about, {SIZE} from there on",
        subtype="PERCENTAGE",
        default=1,
        min=0.001,
        soft_max=50,
        max=1000,
        precision=2,
    )
    largest: FloatProperty(
        name="Largest",
        description=f"Where the last band ends, {SIZE} there. What is larger stays in the rest",
        subtype="PERCENTAGE",
        default=40,
        min=0.01,
        soft_max=100,
        max=1000,
        precision=2,
    )

    def choice(self) -> Choice:
        """The properties as they are."""
        names = Choice.__dataclass_fields__
        return Choice(**{name: getattr(self, name) for name in names})

    def draw_choice(self, layout: bpy.types.UILayout) -> None:
        """Lay out what is chosen, and only what has an effect."""
        column = layout.column()
        column.prop(self, "kind")
        column.prop(self, "source")
        column.prop(self, "result")
        column = layout.column()
        if self.result == "FLOW":
            column.prop(self, "size")
        else:
            column.prop(self, "finest")
            column.prop(self, "largest")
            column.prop(self, "bands")
        if self.result == "FILTER":
            self.draw_filter(layout.column())
        column = layout.column()
        column.prop(self, "law")
        row = column.row()
        row.active = self.law == "TV"
        row.prop(self, "exact")
        column.prop(self, "steps")


class MeasureProperties:
    """Whose values over time are told."""

    parts: EnumProperty(name="Values of", description="Whose values are told", items=PARTS)
    groups: StringProperty(
        name="Groups",
        description="Vertex groups, with commas between; all but those written here if empty",
    )


class SpectralTVAttributes(
    SidebarFilter, AttributeProperties, MeasureProperties, bpy.types.PropertyGroup
):
    """The choices in the sidebar, kept with the scene."""

    group: StringProperty(
        name="Set", description="The vertex group to test; the active one if left empty"
    )


CLASSES = (SpectralTVAttributes,)
