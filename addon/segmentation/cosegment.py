"""The operator that labels the same parts in several poses."""

from functools import partial
from typing import TypeAlias

import bpy
import spectral_tv
from spectral_tv.jobs.steps import Steps, in_turn
from spectral_tv.later import np
from spectral_tv.notes import about
from spectral_tv.refusal import Refusal
from spectral_tv.segmentation.settings import DECOMPOSING, METHOD

from ..job.jobs import Seen, read_each, unchanged
from ..job.operator import JobOperator
from ..scene import mix
from ..scene.surface import Surface
from . import segments
from .properties import SegmentationChoices

# What was read of each object.
Prepared = list[tuple[Seen, Surface]]
Labels: TypeAlias = "list[np.ndarray]"


class SPECTRAL_TV_OT_cosegment(JobOperator, SegmentationChoices, bpy.types.Operator):
    """Find the parts of all selected meshes together: the same part gets the same number and
    color in every pose. The meshes need not have the same vertices"""

    bl_idname = "spectral_tv.cosegment"
    bl_label = "Segment Selected"
    working = "Segmenting"
    columns = ("parts seed outputs",)

    def prepare(self, _obj: bpy.types.Object) -> Prepared:
        if not self.outputs:
            raise Refusal("choose what to write")
        return read_each(bpy.context, lambda obj: (Seen.of(obj), Surface.read(obj, mix.shown(obj))))

    def start(self, prepared: Prepared) -> Steps[Labels]:
        starts = [
            partial(spectral_tv.start_decompose, surface.mesh, METHOD, steps=self.steps)
            for _, surface in prepared
        ]
        count, seed = self.segments, self.seed

        def steps():
            splits = yield from in_turn(starts, DECOMPOSING)
            return (yield spectral_tv.start_cosegment(splits, count, seed), 1.0)

        return Steps(steps())

    def write(self, _obj: bpy.types.Object, prepared: Prepared, result: Labels) -> str:
        objects, skipped = unchanged([seen for seen, _ in prepared])
        for obj, (_, surface), labels in zip(objects, prepared, result, strict=True):
            if obj is not None:
                with about(obj.name):
                    segments.write(obj, surface.to_vertices(labels), self.segments, self.outputs)
        written = len(objects) - objects.count(None)
        return f"{self.segments} parts in {written} meshes{skipped}"
