"""The operator that selects what a message is about."""

import bmesh
import bpy
from spectral_tv.refusal import Refusal

from ..scene.modes import show_vertices
from . import faults
from .operator import ChangeOperator


class SPECTRAL_TV_OT_select_faulty(ChangeOperator, bpy.types.Operator):
    """Select the vertices that the message is about, in Edit Mode: to delete them, or to give them
    coordinates in the sidebar's tab Item"""

    bl_idname = "spectral_tv.select_faulty"
    bl_label = "Select Vertices"

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        known = faults.of(context.active_object) is not None
        return None if known else "No vertex of the active object was refused"

    def change(self, context: bpy.types.Context, obj: bpy.types.Object) -> str:
        if obj.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        fault = faults.of(obj)
        if fault is None:
            raise Refusal("its vertices changed since; run it again")
        show_vertices()
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="DESELECT")
        edited = bmesh.from_edit_mesh(obj.data)
        edited.verts.ensure_lookup_table()
        for index in fault.vertices:
            vertex = edited.verts[index]
            vertex.hide_set(False)
            vertex.select_set(True)
        bmesh.update_edit_mesh(obj.data, loop_triangles=False, destructive=False)
        count = len(fault.vertices)
        vertices = "1 vertex" if count == 1 else f"{count} vertices"
        return f"{vertices} selected"
