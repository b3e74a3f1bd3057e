"""Operators that edit the list of constraints."""

import bmesh
import bpy
from bpy.props import EnumProperty
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

from ..job.operator import ChangeOperator
from ..scene.objects import refusal
from . import constraints, empties, handles


class ConstraintOperator(ChangeOperator):
    """What all of them share."""

    needs_constraint = True

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        obj = context.active_object
        reason = refusal(obj, edit_mode=True)
        if reason is None and cls.needs_constraint and constraints.chosen(obj) is None:
            return "No constraint is chosen"
        return reason


class SPECTRAL_TV_OT_constraint_add(ConstraintOperator, bpy.types.Operator):
    """Constrain a vertex group: the selected vertices in Edit Mode, else the active group"""

    bl_idname = "spectral_tv.constraint_add"
    bl_label = "Add Constraint"
    needs_constraint = False

    kind: EnumProperty(name="Kind", description="Where the vertices go", items=constraints.KINDS)

    @classmethod
    def description(cls, _context, properties) -> str:
        told = next(item[2] for item in constraints.KINDS if item[0] == properties.kind)
        return f"{told}. Takes the selected vertices in Edit Mode, else the active vertex group"

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> None:
        label = next(item[1] for item in constraints.KINDS if item[0] == self.kind)
        group = _selected_group(obj, label)
        empties.constrain(obj, group, self.kind)
        _, weights = handles.group_weights(obj, [group])[group]
        if len(weights) and weights.max() < 1:
            note(
                f"no vertex of {group!r} has the weight 1, so that it follows like by springs: the "
                f"largest is {weights.max():.2g}"
            )


class SPECTRAL_TV_OT_constraint_remove(ConstraintOperator, bpy.types.Operator):
    """Remove the chosen constraint; its vertex group and its object stay"""

    bl_idname = "spectral_tv.constraint_remove"
    bl_label = "Remove Constraint"

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> None:
        deformation = constraints.deformation_of(obj)
        deformation.constraints.remove(deformation.active)
        deformation.active = max(deformation.active - 1, 0)


class SPECTRAL_TV_OT_constraint_rest(ConstraintOperator, bpy.types.Operator):
    """Take the present place of the handle for its rest: it moves nothing until it is moved"""

    bl_idname = "spectral_tv.constraint_rest"
    bl_label = "Set Rest"

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> None:
        constraints.chosen(obj).set_rest()


def _selected_group(obj: bpy.types.Object, label: str) -> str:
    """The group to constrain: a new one of the selection in Edit Mode, else the active one."""
    if obj.mode == "EDIT":
        # Not by Blender's operator, which heeds the weight and other settings of tools.
        edited = bmesh.from_edit_mesh(obj.data)
        selected = [vertex for vertex in edited.verts if vertex.select]
        if not selected:
            raise Refusal("select the vertices to constrain")
        group = obj.vertex_groups.new(name=label)
        weights = edited.verts.layers.deform.verify()
        for vertex in selected:
            vertex[weights][group.index] = 1.0
        bmesh.update_edit_mesh(obj.data, loop_triangles=False, destructive=False)
        obj.update_from_editmode()
        obj.vertex_groups.active_index = group.index
    elif obj.vertex_groups.active is None:
        raise Refusal(f"it has no vertex group to constrain; {constraints.FIRST_STEPS}")
    return obj.vertex_groups.active.name
