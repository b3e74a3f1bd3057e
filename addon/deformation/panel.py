"""The panel that deforms the active mesh, with its sub-panels."""

import bpy
from spectral_tv.deformation.settings import TURNING, label_of

from ..drawing.sidebar import Sidebar, say
from ..drawing.work import MeshPanel, draw_button, draw_fault
from ..options import rows
from ..scene.objects import is_mesh
from ..scene.places import is_in_a_scene
from . import constraints, deform, turning
from .bake_operator import SPECTRAL_TV_OT_bake_deformation
from .constraint_operators import (
    SPECTRAL_TV_OT_constraint_add,
    SPECTRAL_TV_OT_constraint_remove,
    SPECTRAL_TV_OT_constraint_rest,
)
from .deform_operator import SPECTRAL_TV_OT_deform
from .live_operator import SPECTRAL_TV_OT_deform_live
from .pick_operator import SPECTRAL_TV_OT_hold_and_pull
from .rig_operator import SPECTRAL_TV_OT_rig_from_pose


class SPECTRAL_TV_UL_constraints(bpy.types.UIList):
    """The constraints of an object"""

    def draw_item(
        self, _context, layout, _data, item, _icon, _active_data, _active_property, _index
    ) -> None:
        icon = next(kind[3] for kind in constraints.KINDS if kind[0] == item.kind)
        group = item.vertex_group or "(no vertex group)"
        layout.label(text=group, icon=icon, translate=False)
        row = layout.row()
        row.alignment = "RIGHT"
        row.active = False
        row.label(text=_destination(item), translate=False)


def _destination(constraint: constraints.SpectralTVConstraint) -> str:
    if constraint.kind == "OBJECT":
        if constraint.target is None:
            return "(none)"
        if not is_in_a_scene(constraint.target):
            return f"({constraint.target.name} was deleted)"
        return constraint.bone or constraint.target.name
    return constraint.shape_key if constraint.kind == "KEY" else ""


def _advice(obj: bpy.types.Object) -> str | None:
    """What to do first, in a mode in which that can be done."""
    if obj.mode == "EDIT" and not constraints.deformation_of(obj).constraints:
        return "Select what stays and press the pin, then what moves and press the arrows"
    return None


class SPECTRAL_TV_PT_deform(MeshPanel, bpy.types.Panel):
    """Pull on parts of the mesh"""

    bl_label = "Deform"
    bl_order = 1

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return super().poll(context) or SPECTRAL_TV_OT_deform_live.running is not None

    def rows(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        if is_mesh(context.active_object):
            super().rows(context, layout)
        else:  # a handle is being dragged
            text = f"End Live of {SPECTRAL_TV_OT_deform_live.running.object_name}"
            draw_button(layout, SPECTRAL_TV_OT_deform_live, "PAUSE", text=text)
            self._draw_state(layout, context)

    def choices(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        obj = context.active_object
        deformation = constraints.deformation_of(obj)
        first = not deformation.constraints
        draw_button(layout, SPECTRAL_TV_OT_hold_and_pull, "RESTRICT_SELECT_OFF", is_tall=first)
        self._draw_list(layout, deformation)
        if deformation.constraints:
            layout.prop(deformation, "shows_regions")
        if constraints.chosen(obj) is not None:
            self._draw_constraint(layout.column(), obj)
        rows.draw(layout, deformation, "follow")
        self._draw_turning(layout, context, obj)

    def actions(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        obj = context.active_object
        is_live = SPECTRAL_TV_OT_deform_live.running is not None
        reason = _advice(obj) or deform.deform_refusal(obj)
        if reason is not None and not is_live:
            say(layout, context, reason, "INFO")
            if reason == deform.shared_refusal(obj):
                single = layout.operator("object.make_single_user", icon="DUPLICATE")
                single.object = single.obdata = True
        self._draw_state(layout, context)
        draw_fault(layout, context)
        row = layout.row(align=True)
        row.scale_y = 1.4
        row.operator(SPECTRAL_TV_OT_deform.bl_idname, icon="MOD_SIMPLEDEFORM")
        row.operator(
            SPECTRAL_TV_OT_deform_live.bl_idname,
            icon="PAUSE" if is_live else "PLAY",
            depress=is_live,
        )
        if constraints.deformation_of(obj).algorithm == "POSE":
            layout.operator(SPECTRAL_TV_OT_rig_from_pose.bl_idname, icon="ARMATURE_DATA")

    @staticmethod
    def _draw_state(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
        """Draw what Live prepares, or waits for."""
        live = SPECTRAL_TV_OT_deform_live.running
        if live is not None and live.preparation is not None:
            done = live.preparation
            layout.progress(text=f"Preparing ({done:.0%})", factor=done)
        if live is not None and live.problem:
            say(layout, context, f"Waiting: {live.problem}", "ERROR")

    @staticmethod
    def _draw_turning(
        layout: bpy.types.UILayout, context: bpy.types.Context, obj: bpy.types.Object
    ) -> None:
        """Draw that pieces do not turn with their handles, and buttons for what turns them."""
        deformation = constraints.deformation_of(obj)
        text = turning.told(turning.of_handles(obj), deformation.algorithm)
        if text is None:
            return
        say(layout, context, text[0].upper() + text[1:], "INFO")
        column = layout.column()
        column.use_property_split = False
        if deformation.algorithm == "POSE":
            for constraint in deformation.constraints:
                if constraint.is_free and turning.of_handle(constraint) >= turning.NOTICED:
                    label = f"Turn {constraint.vertex_group} with Handle"
                    column.prop(constraint, "turns", text=label, toggle=True, translate=False)
            return
        for algorithm in TURNING:
            label = f"Take {label_of(algorithm)}"
            column.prop_enum(deformation, "algorithm", algorithm, text=label)

    @staticmethod
    def _draw_list(layout: bpy.types.UILayout, deformation) -> None:
        row = layout.row()
        row.template_list(
            "SPECTRAL_TV_UL_constraints", "", deformation, "constraints", deformation, "active",
            rows=4,
        )  # fmt: skip
        column = row.column(align=True)
        for kind, _, _, icon, _ in constraints.KINDS:
            add = column.operator(SPECTRAL_TV_OT_constraint_add.bl_idname, text="", icon=icon)
            add.kind = kind
        column.separator()
        column.operator(SPECTRAL_TV_OT_constraint_remove.bl_idname, text="", icon="REMOVE")

    @staticmethod
    def _draw_constraint(layout: bpy.types.UILayout, obj: bpy.types.Object) -> None:
        constraint = constraints.chosen(obj)
        layout.prop_search(constraint, "vertex_group", obj, "vertex_groups")
        layout.prop(constraint, "kind")
        if constraint.kind == "OBJECT":
            layout.prop(constraint, "target")
            target = constraint.target
            if target is not None and target.type == "ARMATURE":
                layout.prop_search(constraint, "bone", target.pose, "bones")
            if constraints.deformation_of(obj).algorithm == "POSE":
                layout.prop(constraint, "turns")
            layout.operator(SPECTRAL_TV_OT_constraint_rest.bl_idname)
        elif constraint.kind == "KEY" and obj.data.shape_keys is not None:
            layout.prop_search(constraint, "shape_key", obj.data.shape_keys, "key_blocks")
        elif constraint.kind == "KEY":
            layout.label(text="The mesh has no shape keys", icon="INFO")


class SPECTRAL_TV_PT_bake_deformation(Sidebar, bpy.types.Panel):
    """Turn moving handles into a shape-key animation"""

    bl_label = "Animation"
    bl_parent_id = "SPECTRAL_TV_PT_deform"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return is_mesh(context.active_object)

    def rows(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        scene = context.scene
        deformation = constraints.deformation_of(context.active_object)
        column = layout.column(align=True)
        column.prop(scene, "frame_start", text="Frame Start")
        column.prop(scene, "frame_end", text="End")
        column.prop(deformation, "bake_step")
        bake = layout.operator(SPECTRAL_TV_OT_bake_deformation.bl_idname, icon="ACTION")
        bake.frame_start, bake.frame_end = scene.frame_start, scene.frame_end
        bake.step = deformation.bake_step
