"""The operator that selects what a message is about."""

import bpy
import numpy as np

from .. import faults


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
        mesh = obj.data
        for elements in (mesh.polygons, mesh.edges):
            elements.foreach_set("select", np.zeros(len(elements), dtype=bool))
        is_chosen = np.zeros(len(mesh.vertices), dtype=bool)
        is_chosen[fault.vertices] = True
        is_hidden = np.empty(len(mesh.vertices), dtype=bool)
        mesh.vertices.foreach_get("hide", is_hidden)
        mesh.vertices.foreach_set("hide", is_hidden & ~is_chosen)
        mesh.vertices.foreach_set("select", is_chosen)
        context.tool_settings.mesh_select_mode = (True, False, False)
        bpy.ops.object.mode_set(mode="EDIT")
        count = len(fault.vertices)
        vertices = "1 vertex" if count == 1 else f"{count} vertices"
        self.report({"INFO"}, f"{obj.name}: {vertices} selected")
        return {"FINISHED"}


CLASSES = (SPECTRAL_TV_OT_select_faulty,)
