"""The operator that has objects follow the bands of a body."""

import bpy
from spectral_tv.notes import listed, note
from spectral_tv.refusal import Refusal

from . import carrying
from .set_bands import BandsOperator


class SPECTRAL_TV_OT_carry_along(BandsOperator, bpy.types.Operator):
    """Have the other selected meshes, such as clothes, hair cards, eyes and teeth, follow the bands
    of the active one: by shape keys of theirs that its sliders drive. What is outside of it stays
    outside at gains up to 1"""

    bl_idname = "spectral_tv.carry_along"
    bl_label = "Carry Along"

    def change(self, context: bpy.types.Context, obj: bpy.types.Object) -> str:
        others = [each for each in context.selected_objects if each != obj]
        meshes = [each for each in others if each.type == "MESH"]
        if not meshes:
            raise Refusal("select the meshes that follow it too, and it last")
        left = [each.name for each in others if each.type != "MESH"]
        if left:
            note(f"only meshes have shape keys, so these do not follow: {listed(left)}")
        return carrying.carried_along(obj, meshes)
