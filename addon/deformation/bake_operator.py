"""The operator that turns moving handles into a shape-key animation."""

from typing import Any

import bpy
from bpy.props import IntProperty
from spectral_tv.command_line.frames import every
from spectral_tv.jobs.steps import Steps
from spectral_tv.refusal import Refusal

from ..job.operator import JobOperator
from ..job.progress import cursor_progress
from . import baking, deform


class SPECTRAL_TV_OT_bake_deformation(JobOperator, bpy.types.Operator):
    """Deform on every chosen frame: one shape key each, with values that play them one after
    the other. Baking again replaces them"""

    bl_idname = "spectral_tv.bake_deformation"
    bl_label = "Bake Animation"
    working = "Baking"

    frame_start: IntProperty(name="Start", description="First frame", default=1)
    frame_end: IntProperty(name="End", description="Last frame", default=40)
    step: IntProperty(
        name="Step",
        description="Frames from one key to the next; the last frame always has one", default=1,
        min=1
    )  # fmt: skip

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return deform.follow_refusal(context.active_object)

    def prepare(self, obj: bpy.types.Object) -> Any:
        if self.frame_end < self.frame_start:
            raise Refusal(f"frame {self.frame_end} comes before frame {self.frame_start}")
        with cursor_progress(bpy.context) as progress:
            return baking.prepare(obj, self._frames(), progress)

    def start(self, prepared: Any) -> Steps:
        _, targets, follower = prepared
        return follower.start_sequence(targets)

    def write(self, obj: bpy.types.Object, prepared: Any, result: Any) -> str:
        deformable, _, follower = prepared
        return baking.write(obj, self._frames(), deformable, follower, result)

    def _frames(self) -> list[int]:
        return every(self.frame_start, self.frame_end, self.step)
