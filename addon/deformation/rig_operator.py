"""The operator that makes an armature of the pose of the active mesh."""

from dataclasses import replace
from typing import Any

import bpy
import numpy as np
from spectral_tv.deformation.solvers.pose import Posing
from spectral_tv.jobs.steps import Steps
from spectral_tv.refusal import Refusal

from ..job.operator import JobOperator
from . import armature, results
from .bones import bones_of, unlikeness
from .constraints import deformation_of
from .deform import Deformable, deform_refusal, is_same_metric, metric_of, prepare

# What was read of the object, the targets of its grips, and what poses it.
Prepared = tuple[Deformable, np.ndarray, Posing]


class SPECTRAL_TV_OT_rig_from_pose(JobOperator, bpy.types.Operator):
    """Pose the mesh by its constraints, and make an armature of it that is posed likewise: a bone
    for each piece that moves rigidly, with soft weights at the joints"""

    bl_idname = "spectral_tv.rig_from_pose"
    bl_label = "Rig from Pose"
    working = "Rigging"

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return deform_refusal(context.active_object)

    def prepare(self, obj: bpy.types.Object) -> Prepared:
        settings = replace(deformation_of(obj).settings(), algorithm="POSE")
        return prepare(obj, settings, [each.name for each in armature.former(obj)])

    def start(self, prepared: Prepared) -> Steps:
        _, targets, posing = prepared
        return posing.start_rig(targets)

    def write(self, obj: bpy.types.Object, prepared: Prepared, result: Any) -> str:
        deformable, _, posing = prepared
        solved, rig = result
        if not is_same_metric(metric_of(obj), deformable.surface.metric):
            raise Refusal("nothing was written, as its scale changed in the meantime")
        bones = bones_of(deformable.surface, rig)
        if len(bones) < 2:
            raise Refusal(
                "nothing bends: all of it is one rigid piece. Move a handle first, so that it "
                "bends where joints are wanted"
                if bones
                else "no part of it stays rigid. Move the handles less far"
            )
        written = armature.write(obj, bones)
        results.hide(obj)
        apart = unlikeness(deformable.surface, rig, solved.result.vertices)
        return (
            f"rig of {len(bones)} bones, {written.name!r}, which shows the pose to within "
            f"{max(apart, 1e-4):.2%} of the size; {posing.message(solved)}"
        )
