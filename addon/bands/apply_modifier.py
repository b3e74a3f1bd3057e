"""The operator that applies modifiers to a mesh with shape keys."""

import bpy
from bpy.props import StringProperty
from spectral_tv.notes import gathered
from spectral_tv.refusal import Refusal

from ..job.operator import Refusing
from ..scene.applying import FOLLOWERS, apply_modifier, farthest
from ..scene.attribute_band import has_bands
from ..scene.coordinates import seen_coordinates
from ..scene.objects import refusal

# How far, relative to the size, what is seen may move untold.
VISIBLE = 1e-5


class SPECTRAL_TV_OT_apply_modifier(Refusing, bpy.types.Operator):
    """Apply a modifier to the mesh and to each of its shape keys, which stay with all that animates
    them; Blender itself applies none to a mesh with shape keys"""

    bl_idname = "spectral_tv.apply_modifier"
    bl_label = "Apply Modifier, Keep Keys"

    modifier: StringProperty(
        name="Modifier",
        description="Which one; all that are enabled, one after the other, if left empty",
        options={"SKIP_SAVE"},
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return apply_refusal(context.active_object)

    def execute(self, context: bpy.types.Context) -> set[str]:
        obj = context.active_object
        enabled = [each.name for each in appliable(obj) if each.show_viewport]
        before = seen_coordinates(obj)
        renewals = [follow(obj) for follow in FOLLOWERS]
        applied = []
        with gathered() as notes:
            try:
                for name in [self.modifier] if self.modifier else enabled:
                    apply_modifier(obj, name)
                    applied.append(name)
            except Refusal as error:
                self.refuse(error, obj)
        if not applied:
            return {"CANCELLED"}
        for renew in renewals:
            renew()
        moved = farthest(before, seen_coordinates(obj))
        if moved > VISIBLE * obj.dimensions.length:
            notes.append(
                f"what is seen has changed, by up to {moved:.2g}: modifiers were applied to each "
                "shape key by itself, and do not treat their sum or their masks so"
            )
        return self.tell(obj, f"applied {', '.join(map(repr, applied))}", notes)


def appliable(obj: bpy.types.Object) -> list[bpy.types.Modifier]:
    """The modifiers of an object but for those of bands, which Apply Look applies."""
    return [each for each in obj.modifiers if not has_bands(each)]


def apply_refusal(obj: bpy.types.Object | None) -> str | None:
    """Why no modifier can be applied now, in a sentence for the user; None if one can be."""
    reason = refusal(obj)
    if reason is not None:
        return reason
    if obj.mode != "OBJECT":
        return "Go to Object Mode first"
    if obj.data.shape_keys is None:
        return "The mesh has no shape keys; Blender's own Apply does"
    if not appliable(obj):
        return "The object has no modifiers"
    if not any(each.show_viewport for each in appliable(obj)):
        return "All its modifiers are disabled in the viewport"
    return None
