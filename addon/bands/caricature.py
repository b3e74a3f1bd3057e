"""The operator that exaggerates all selected meshes alike."""

from dataclasses import dataclass
from functools import partial
from typing import Any

import bpy
import spectral_tv

from ..job.jobs import Chain, Seen, read_each, unchanged
from ..job.operator import JobOperator
from ..scene.notes import about, note
from ..scene.objects import Refusal
from ..scene.surface import Surface
from ..scene.whole import whole
from .bands import add_bands, prepare, recall, set_values
from .gains import caricature_values
from .properties import CaricatureProperties
from .settings import Settings


@dataclass(frozen=True)
class Pose:
    """What is to be decomposed of an object, and by what."""

    seen: Seen
    surface: Surface
    arguments: dict[str, Any]


class SPECTRAL_TV_OT_caricature(JobOperator, CaricatureProperties, bpy.types.Operator):
    """Split all selected meshes into bands alike, and exaggerate the same bands of each; the
    finest ones can be smoothed away. Different poses then keep one character"""

    bl_idname = "spectral_tv.caricature"
    bl_label = "Exaggerate Selected"
    working = "Exaggerating"

    def prepare(self, _obj: bpy.types.Object) -> list[Pose]:
        if self.smooth >= self.bands:
            raise Refusal(f"smoothing {self.smooth} of {self.bands} bands leaves none")
        return read_each(
            bpy.context, lambda obj: Pose(Seen.of(obj), *prepare(obj, self._settings()))
        )

    def recall(self, prepared: list[Pose]) -> list[spectral_tv.Decomposition] | None:
        splits = [recall(pose.surface, pose.arguments) for pose in prepared]
        return None if None in splits else splits

    def start(self, prepared: list[Pose]) -> Chain:
        return Chain(
            [
                partial(spectral_tv.start_decompose, pose.surface.mesh, **pose.arguments)
                for pose in prepared
            ]
        )

    def write(
        self,
        _obj: bpy.types.Object,
        prepared: list[Pose],
        result: list[spectral_tv.Decomposition],
    ) -> str:
        values = caricature_values(self.bands, self.first, self.last, self.amount, self.smooth)
        if not any(values):
            note("the filter changes nothing: the amount is 0, and no band is smoothed")
        objects, skipped = unchanged([pose.seen for pose in prepared])
        there = [obj for obj in objects if obj is not None]
        with whole(*there):
            for obj, pose, split in zip(objects, prepared, result, strict=True):
                if obj is not None:
                    add_bands(obj, self._settings(), pose.surface, pose.arguments, split)
        for obj in there:
            with about(obj.name):
                set_values(obj, values)
        done = f"{self.bands} bands of {self.method} exaggerated alike in {len(there)} meshes"
        return done + skipped

    def _settings(self) -> Settings:
        return Settings(method=self.method, bands=self.bands, steps=self.steps)


CLASSES = (SPECTRAL_TV_OT_caricature,)
