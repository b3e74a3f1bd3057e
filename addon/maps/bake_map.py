"""The operator that bakes a map."""

import bpy
from bpy.props import StringProperty
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

from ..bands.set_bands import BandsOperator
from ..job.progress import cursor_progress
from ..options.properties import RELATIVE, choices_of
from ..scene.objects import refusal
from . import baking, files, materials, telling
from .settings import MapSettings


class MapChoices(choices_of(MapSettings, "map")):
    """What the operator and the panel both ask for."""

    filepath: StringProperty(
        name="File",
        description="The map, an .exr, or a .png of normals; beside the .blend if none is named",
        subtype="FILE_PATH",
        options=RELATIVE,
    )


class SPECTRAL_TV_OT_bake_map(BandsOperator, MapChoices, bpy.types.Operator):
    """Bake the look, or a band, to a map over UVs, by Cycles. Blender does not respond meanwhile,
    and it cannot be cancelled"""

    bl_idname = "spectral_tv.bake_map"
    bl_label = "Bake Map"

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        reason = refusal(context.active_object, override=True)
        if reason is None and context.active_object.mode != "OBJECT":
            reason = "Go to Object Mode first"
        return reason

    def draw(self, context: bpy.types.Context) -> None:
        super().draw(context)
        self.layout.prop(self, "filepath")

    def change(self, context: bpy.types.Context, obj: bpy.types.Object) -> str:
        asked = self.settings()
        other = other_selected(context) if asked.onto == "OTHER" else None
        target = files.target_of(obj, self.filepath, asked)
        with cursor_progress(context) as show:
            baked = baking.bake(obj, other, asked, show)
            is_over = target.exists()
            try:
                files.write(target, baked)
            except OSError as error:
                raise Refusal(str(error)) from error
        if is_over:
            note(f"{target.name} was written over")
        if asked.material:
            materials.show_map(other or obj, target, baked.kind, baked.uv_map)
            if other is None:
                note("its bands act beneath the map; Show Original has the map alone")
        return telling.told(baked, asked, target)


def other_selected(context: bpy.types.Context) -> bpy.types.Object:
    """The mesh that is selected beside the active object; raises Refusal if it is not one."""
    others = [obj for obj in context.selected_objects if obj != context.active_object]
    meshes = [obj for obj in others if obj.type == "MESH"]
    if len(meshes) != 1:
        raise Refusal("select one other mesh too, whose UVs the map is for")
    reason = refusal(meshes[0], override=True)
    if reason is not None:
        raise Refusal(f"{meshes[0].name!r}: {reason}")
    return meshes[0]
