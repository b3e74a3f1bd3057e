"""The operator that shows the original, and the look again."""

import bpy

from ..scene.records import records_of
from . import original
from .set_bands import BandsOperator, bands_refusal


class SPECTRAL_TV_OT_show_original(BandsOperator, bpy.types.Operator):
    """Show the object without the bands of all decompositions, as before them; again to have the
    look back. Values, mutes and solo stay what they are"""

    bl_idname = "spectral_tv.show_original"
    bl_label = "Show Original"

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return bands_refusal(context.active_object, original_too=True)

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> str:
        if original.is_shown(obj):
            original.end(obj)
            return "its look is shown"
        original.show(obj)
        names = ", ".join(record.name for record in records_of(obj))
        return f"the original is shown, without {names}"
