"""The operator that splits the active mesh into bands."""

from collections.abc import Callable
from contextlib import ExitStack
from typing import Any

import bpy
import spectral_tv
from bpy.props import BoolProperty
from spectral_tv.bands.settings import ON_NEW_OBJECT, Settings
from spectral_tv.dataclass import dataclass
from spectral_tv.jobs.together import Together

from ..job.jobs import Seen, all_unchanged
from ..job.operator import JobOperator
from ..scene.objects import distinct_meshes
from ..scene.records import record_of
from ..scene.surface import Surface
from . import adding, replacing, shown_shape
from .bands import parts_of, prepare_together, recall, start_split
from .properties import DecompositionChoices

# What follows when bands were written. Each is called with the object and the settings.
WRITTEN: list[Callable[[bpy.types.Object, Settings], None]] = []


@dataclass(frozen=True)
class Prepared:
    """The objects, their surfaces, and the arguments of spectral_tv.decompose."""

    seen: list[Seen]
    surfaces: list[Surface]
    arguments: dict[str, Any]
    # Of the decompositions whose place the new ones will take.
    former: list[str]


class SPECTRAL_TV_OT_decompose(JobOperator, DecompositionChoices, bpy.types.Operator):
    """Split the active mesh into bands of detail, one shape key or attribute per band"""

    bl_idname = "spectral_tv.decompose"
    bl_label = "Decompose into Bands"
    working = "Decomposing"

    together: BoolProperty(
        name="Selected as One",
        description="Decompose all selected meshes as one surface, joined where their open edges "
        "meet",
    )

    def prepare(self, obj: bpy.types.Object) -> Prepared:
        if self.together:
            objects = distinct_meshes(bpy.context)
        else:
            objects = parts_of(obj) if self._replaces_any(obj) else [obj]
        seen = [Seen.of(each) for each in objects]
        former = replacing.replaced_identifiers(objects, self.settings())
        return Prepared(seen, *prepare_together(objects, self.settings()), former)

    def _replaces_any(self, obj: bpy.types.Object) -> bool:
        return self.into == "REPLACE_ANY" and record_of(obj) is not None

    def recall(self, prepared: Prepared) -> spectral_tv.Decomposition | None:
        return recall(prepared.surfaces[0], prepared.arguments)

    def start(self, prepared: Prepared) -> spectral_tv.Job | Together:
        return start_split(prepared.surfaces[0].mesh, self.settings(), prepared.arguments)

    def write(
        self, _obj: bpy.types.Object, prepared: Prepared, result: spectral_tv.Decomposition
    ) -> str:
        objects = all_unchanged(prepared.seen)
        replacing.check_replaced(objects, self.settings(), prepared.former)
        with ExitStack() as stack:
            if self.shape in ON_NEW_OBJECT:
                first = objects[0], self.shape, prepared.surfaces[0]
                objects = [stack.enter_context(shown_shape.in_the_place_of(*first))]
            pairs = zip(objects, prepared.surfaces, strict=True)
            parts = [adding.Part(*pair, prepared.arguments, result) for pair in pairs]
            as_one = f", in {len(objects)} objects as one" if len(objects) > 1 else ""
            done = adding.add_bands(parts, self.settings()) + as_one
        for follow in WRITTEN:
            follow(objects[0], self.settings())
        return done
