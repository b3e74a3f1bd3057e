"""The operator that turns moving handles into a shape-key animation."""

from collections.abc import Callable
from typing import Any

import bpy
import numpy as np
import spectral_tv
from bpy.props import IntProperty

from ..animation import play_in_turn, remove_animation
from ..constraints import deformation_of
from ..deformation import Deformable, result_key
from ..objects import Refusal
from ..shape_keys import add_displacements
from ._job import JobOperator
from .deform import deform_refusal


class SPECTRAL_TV_OT_bake_deformation(JobOperator, bpy.types.Operator):
    """Deform on every chosen frame: one shape key each, with values that play them one after
    the other. Baking again replaces them"""

    bl_idname = "spectral_tv.bake_deformation"
    bl_label = "Bake Animation"
    bl_options = {"REGISTER", "UNDO"}
    working = "Baking"

    frame_start: IntProperty(name="Start", description="First frame", default=1)
    frame_end: IntProperty(name="End", description="Last frame", default=40)
    step: IntProperty(name="Step", description="Frames from one key to the next", default=1, min=1)

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return deform_refusal(context.active_object)

    def prepare(self, obj: bpy.types.Object) -> tuple[Deformable, list[np.ndarray], Any]:
        if self.frame_end < self.frame_start:
            raise Refusal(f"frame {self.frame_end} comes before frame {self.frame_start}")
        deformable = Deformable.read(obj)
        scene = bpy.context.scene
        frame, subframe = scene.frame_current, scene.frame_subframe
        try:
            targets = []
            for number in self._frames():
                scene.frame_set(number)
                targets.append(deformable.targets(obj))
        finally:
            scene.frame_set(frame, subframe=subframe)
        deformer = spectral_tv.Deformer(
            deformable.surface.mesh,
            deformable.indices,
            deformable.handles.weights,
            deformable.softness(deformation_of(obj).softness),
        )
        return deformable, targets, deformer

    def work(self, prepared: Any, progress: Callable[[float], None]) -> Any:
        _, targets, deformer = prepared
        return deformer.solve_sequence(targets, progress=progress)

    def start(self, prepared: Any) -> spectral_tv.Job:
        _, targets, deformer = prepared
        return deformer.start_solve_sequence(targets)

    def write(self, obj: bpy.types.Object, prepared: Any, result: Any) -> str:
        deformable = prepared[0]
        deformation = deformation_of(obj)
        _remove_baked(obj)
        frames = self._frames()
        single = result_key(obj)
        if single is not None:
            single.value = 0.0  # it would be added to the baked ones
        names = [f"Deformation {frame}" for frame in frames]
        displacements = np.stack([deformable.displacement(each) for each in result])
        keys = add_displacements(obj, names, displacements)
        play_in_turn(obj, keys, frames)
        for key in keys:
            deformation.baked.add().name = key.name
        return f"{len(keys)} frames baked"

    def _frames(self) -> list[int]:
        return list(range(self.frame_start, self.frame_end + 1, self.step))


def _remove_baked(obj: bpy.types.Object) -> None:
    """Remove the shape keys of an earlier baking, and their animation."""
    baked = deformation_of(obj).baked
    keys = obj.data.shape_keys
    for entry in baked if keys is not None else ():
        key = keys.key_blocks.get(entry.name)
        if key is not None:
            remove_animation(obj, key)
            obj.shape_key_remove(key)
    baked.clear()


CLASSES = (SPECTRAL_TV_OT_bake_deformation,)
