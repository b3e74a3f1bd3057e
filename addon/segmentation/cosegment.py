"""The operator that labels the same parts in several poses."""

from collections.abc import Callable

import bpy
import numpy as np
import spectral_tv

from ..job import faults, jobs
from ..job.operator import JobOperator
from ..scene import mix
from ..scene.notes import about
from ..scene.objects import Refusal, distinct_meshes, refusal
from ..scene.surface import Surface
from . import segments
from .properties import SegmentationProperties

# The objects by name with their surfaces, and what they looked like.
Prepared = list[tuple[str, Surface, str]]
Labels = list[np.ndarray]
METHOD = "m2"


class SPECTRAL_TV_OT_cosegment(JobOperator, SegmentationProperties, bpy.types.Operator):
    """Find the parts of all selected meshes together: the same part gets the same number and
    color in every pose. The meshes need not have the same vertices"""

    bl_idname = "spectral_tv.cosegment"
    bl_label = "Segment Selected"
    bl_options = {"REGISTER", "UNDO"}
    working = "Segmenting"

    def prepare(self, _obj: bpy.types.Object) -> Prepared:
        if not self.outputs:
            raise Refusal("choose what to write")
        prepared = []
        for obj in distinct_meshes(bpy.context):
            try:
                with faults.kept(obj):
                    surface = Surface.read(obj, mix.shown(obj))
            except (Refusal, spectral_tv.MeshError) as error:
                raise Refusal(f"{obj.name}: {error}") from error
            prepared.append((obj.name, surface, jobs.state_of(obj)))
        return prepared

    def work(self, prepared: Prepared, progress: Callable[[float], None]) -> Labels:
        share = 0.95 / len(prepared)
        splits = []
        for index, (_, surface, _) in enumerate(prepared):

            def told(fraction: float, before: int = index) -> None:
                progress(share * (before + fraction))

            splits.append(
                spectral_tv.decompose(surface.mesh, METHOD, steps=self.steps, progress=told)
            )
        return spectral_tv.cosegment(splits, self.segments, self.seed)

    def start(self, prepared: Prepared) -> jobs.Chain:
        starts = [
            lambda surface=surface: spectral_tv.start_decompose(
                surface.mesh, METHOD, steps=self.steps
            )
            for _, surface, _ in prepared
        ]
        count, seed = self.segments, self.seed
        return jobs.Chain(starts, lambda splits: spectral_tv.start_cosegment(splits, count, seed))

    def write(self, _obj: bpy.types.Object, prepared: Prepared, result: Labels) -> str:
        skipped = []
        for (name, surface, state), labels in zip(prepared, result, strict=True):
            obj = bpy.data.objects.get(name)
            if refusal(obj) is not None or jobs.state_of(obj) != state:
                skipped.append(name)
                continue
            with about(obj.name):
                segments.write(obj, surface.to_vertices(labels), self.segments, self.outputs)
        text = f"{self.segments} parts in {len(prepared) - len(skipped)} meshes"
        if skipped:
            text += f"; changed in the meantime and left as they are: {', '.join(skipped)}"
        return text


CLASSES = (SPECTRAL_TV_OT_cosegment,)
