"""The operator that selects what a message is about."""

import bmesh
import bpy

from . import faults


class SPECTRAL_TV_OT_select_faulty(bpy.types.Operator):
    """Select the vertices that the message is about, in Edit Mode: to delete them, or to give them
    coordinates in the sidebar's tab Item"""

    bl_idname = "spectral_tv.select_faulty"
    bl_label = "Select Vertices"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if faults.of(context.active_object) is not None:
            return True
        cls.poll_message_set("No vertex of the active object was refused")
        return False

    def execute(self, context: bpy.types.Context) -> set[str]:
        obj = context.active_object
        if obj.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        fault = faults.of(obj)
        if fault is None:
            self.report({"ERROR"}, f"{obj.name}: its vertices changed since; run it again")
            return {"CANCELLED"}
        context.tool_settings.mesh_select_mode = (True, False, False)
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
        self.report({"INFO"}, f"{obj.name}: {vertices} selected")
        return {"FINISHED"}


CLASSES = (SPECTRAL_TV_OT_select_faulty,)
