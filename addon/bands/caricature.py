"""The operator that exaggerates all selected meshes alike."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import bpy
import spectral_tv

from ..job import faults, jobs
from ..job.operator import JobOperator
from ..scene.notes import about, note
from ..scene.objects import Refusal, distinct_meshes, refusal
from ..scene.surface import Surface
from ..scene.whole import whole
from .bands import add_bands, prepare, recall, set_values
from .gains import caricature_values
from .properties import CaricatureProperties
from .settings import Settings


@dataclass(frozen=True)
class Pose:
    """An object by its name, what it looked like, and what is to be decomposed by what."""

    name: str
    state: str
    surface: Surface
    arguments: dict[str, Any]


class SPECTRAL_TV_OT_caricature(JobOperator, CaricatureProperties, bpy.types.Operator):
    """Split all selected meshes into bands alike, and exaggerate the same bands of each; the
    finest ones can be smoothed away. Different poses then keep one character"""

    bl_idname = "spectral_tv.caricature"
    bl_label = "Exaggerate Selected"
    bl_options = {"REGISTER", "UNDO"}
    working = "Exaggerating"

    def prepare(self, _obj: bpy.types.Object) -> list[Pose]:
        if self.smooth >= self.bands:
            raise Refusal(f"smoothing {self.smooth} of {self.bands} bands leaves none")
        poses = []
        for obj in distinct_meshes(bpy.context):
            try:
                with faults.kept(obj):
                    surface, arguments = prepare(obj, self._settings())
            except (Refusal, spectral_tv.MeshError, MemoryError) as error:
                raise Refusal(f"{obj.name}: {error}") from error
            poses.append(Pose(obj.name, jobs.state_of(obj), surface, arguments))
        return poses

    def recall(self, prepared: list[Pose]) -> list[spectral_tv.Decomposition] | None:
        splits = [recall(pose.surface, pose.arguments) for pose in prepared]
        return None if None in splits else splits

    def work(
        self, prepared: list[Pose], progress: Callable[[float], None]
    ) -> list[spectral_tv.Decomposition]:
        splits = []
        for index, pose in enumerate(prepared):

            def told(fraction: float, before: int = index) -> None:
                progress((before + fraction) / len(prepared))

            splits.append(spectral_tv.decompose(pose.surface.mesh, **pose.arguments, progress=told))
        return splits

    def start(self, prepared: list[Pose]) -> jobs.Chain:
        return jobs.Chain(
            [
                lambda pose=pose: spectral_tv.start_decompose(pose.surface.mesh, **pose.arguments)
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
        found, skipped = [], []
        for pose, split in zip(prepared, result, strict=True):
            obj = bpy.data.objects.get(pose.name)
            if refusal(obj) is not None or jobs.state_of(obj) != pose.state:
                skipped.append(pose.name)
            else:
                found.append((obj, pose, split))
        with whole(*(obj for obj, _, _ in found)):
            for obj, pose, split in found:
                add_bands(obj, self._settings(), pose.surface, pose.arguments, split)
        for obj, _, _ in found:
            with about(obj.name):
                set_values(obj, values)
        text = f"{self.bands} bands of {self.method} exaggerated alike in "
        text += f"{len(prepared) - len(skipped)} meshes"
        if skipped:
            text += f"; changed in the meantime and left as they are: {', '.join(skipped)}"
        return text

    def _settings(self) -> Settings:
        return Settings(method=self.method, bands=self.bands, steps=self.steps)


CLASSES = (SPECTRAL_TV_OT_caricature,)
