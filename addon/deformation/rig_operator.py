"""The operator that makes an armature of the pose of the active mesh."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeAlias

import bpy
from spectral_tv.jobs.steps import Steps
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

from ..job.operator import JobOperator
from . import armature, bones, deform, results
from .constraints import deformation_of

if TYPE_CHECKING:
    from spectral_tv.deformation.solvers.pose import Posing

# What was read of the object, the targets of its grips, and what poses it.
Prepared: TypeAlias = "tuple[deform.Deformable, np.ndarray, Posing]"


class SPECTRAL_TV_OT_rig_from_pose(JobOperator, bpy.types.Operator):
    """Pose the mesh by its constraints, and make an armature of it that is posed likewise: a bone
    for each piece that moves rigidly, with soft weights at the joints"""

    bl_idname = "spectral_tv.rig_from_pose"
    bl_label = "Rig from Pose"
    working = "Rigging"

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return deform.deform_refusal(context.active_object)

    def prepare(self, obj: bpy.types.Object) -> Prepared:
        settings = replace(deformation_of(obj).settings(), algorithm="POSE")
        return deform.prepare(obj, settings, [each.name for each in armature.former(obj)])

    def start(self, prepared: Prepared) -> Steps:
        _, targets, posing = prepared
        return posing.start_rig(targets)

    def write(self, obj: bpy.types.Object, prepared: Prepared, result: Any) -> str:
        deformable, _, posing = prepared
        solved, rig = result
        if not deform.is_same_metric(deform.metric_of(obj), deformable.surface.metric):
            raise Refusal("nothing was written, as its scale changed in the meantime")
        made = bones.bones_of(deformable.surface, rig)
        if len(made) < 2:
            raise Refusal(
                "nothing bends: all of it is one rigid piece. Move a handle first, so that it "
                "bends where joints are wanted"
                if made
                else "no part of it stays rigid. Move the handles less far"
            )
        written = armature.write(obj, made)
        results.hide(obj)
        apart = bones.unlikeness(deformable.surface, rig, solved.result.vertices)
        return (
            f"rig of {len(made)} bones, {written.name!r}, which shows the pose to within "
            f"{max(apart, 1e-4):.2%} of the size; {posing.message(solved)}"
        )
