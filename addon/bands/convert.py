"""The operator that turns bands that are shape keys into attributes, and back."""

import bpy
from bpy.props import EnumProperty, StringProperty
from spectral_tv.bands.settings import BANDS_AS

from ..scene import keeping
from ..scene.records import chosen_record, record_of
from . import converting
from .set_bands import BandsOperator, bands_refusal


class SPECTRAL_TV_OT_convert_bands(BandsOperator, bpy.types.Operator):
    """Turn the bands of a decomposition into attributes that a Geometry Nodes modifier adds, or
    back into shape keys. Values, masks, keyframes and drivers stay"""

    bl_idname = "spectral_tv.convert_bands"
    bl_label = "Convert Bands"
    changes_keys = True

    to: EnumProperty(name="To", description="What they become", items=BANDS_AS)
    name: StringProperty(
        name="Name",
        description="Of the decomposition; the active one if left empty",
        options={"SKIP_SAVE"},
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        obj = context.active_object
        reason = bands_refusal(obj, override=False)
        if reason is not None:
            return reason
        record = record_of(obj)
        return converting.conversion_refusal(obj, record, other_kind(record.kept))

    @classmethod
    def description(cls, _context, properties) -> str:
        if properties.to == "ATTRIBUTES":
            return (
                "Turn the active bands into attributes that a Geometry Nodes modifier adds. "
                "Values, masks, keyframes and drivers stay"
            )
        return "Turn the active bands into shape keys. Values, masks, keyframes and drivers stay"

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> str:
        record = chosen_record(obj, self.name)
        bands = converting.convert(obj, record, self.to)
        return f"{len(bands)} bands of {record.name!r} are {keeping.PLACES[self.to].label} now"


def other_kind(kind: str) -> str:
    """The kind that bands are not of."""
    return next(each for each in keeping.PLACES if each != kind)


def draw(row: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw a button that turns the active bands into the other kind."""
    to = other_kind(record_of(context.active_object).kept)
    icon = "GEOMETRY_NODES" if to == "ATTRIBUTES" else "SHAPEKEY_DATA"
    row.operator(SPECTRAL_TV_OT_convert_bands.bl_idname, text="", icon=icon).to = to
