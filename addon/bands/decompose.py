"""The operator that splits the active mesh into bands."""

from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any

import bpy
import spectral_tv
from bpy.props import BoolProperty

from ..job.jobs import Seen, all_unchanged
from ..job.operator import JobOperator
from ..job.together import Together
from ..scene.objects import distinct_meshes
from ..scene.surface import Surface
from ..scene.whole import whole
from . import shown_shape
from .bands import add_bands, prepare_together, recall, start_split
from .properties import DecompositionChoices
from .settings import ON_NEW_OBJECT


@dataclass(frozen=True)
class Prepared:
    """The objects, their surfaces, and the arguments of spectral_tv.decompose."""

    seen: list[Seen]
    surfaces: list[Surface]
    arguments: dict[str, Any]


class SPECTRAL_TV_OT_decompose(JobOperator, DecompositionChoices, bpy.types.Operator):
    """Split the active mesh into bands of detail, one shape key per band"""

    bl_idname = "spectral_tv.decompose"
    bl_label = "Decompose into Bands"
    working = "Decomposing"

    together: BoolProperty(
        name="Selected as One",
        description="Decompose all selected meshes as one surface, joined where their open edges "
        "meet",
    )

    def prepare(self, obj: bpy.types.Object) -> Prepared:
        objects = distinct_meshes(bpy.context) if self.together else [obj]
        seen = [Seen.of(each) for each in objects]
        return Prepared(seen, *prepare_together(objects, self.settings()))

    def recall(self, prepared: Prepared) -> spectral_tv.Decomposition | None:
        return recall(prepared.surfaces[0], prepared.arguments)

    def start(self, prepared: Prepared) -> spectral_tv.Job | Together:
        return start_split(prepared.surfaces[0].mesh, self.settings(), prepared.arguments)

    def write(
        self, _obj: bpy.types.Object, prepared: Prepared, result: spectral_tv.Decomposition
    ) -> str:
        objects = all_unchanged(prepared.seen)
        with ExitStack() as stack:
            if self.shape in ON_NEW_OBJECT:
                first = objects[0], self.shape, prepared.surfaces[0]
                objects = [stack.enter_context(shown_shape.in_the_place_of(*first))]
            stack.enter_context(whole(*objects))
            for obj, surface in zip(objects, prepared.surfaces, strict=True):
                names = add_bands(obj, self.settings(), surface, prepared.arguments, result)
        bands = "1 band" if len(names) == 1 else f"{len(names)} bands"
        as_one = f" to {len(objects)} objects as one" if len(objects) > 1 else ""
        return f"{bands} of {self.settings().by.key_label} added{as_one}"
