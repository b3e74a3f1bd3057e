"""The operator that bakes the mix of the bands without what folds."""

import bpy
from bpy.props import BoolProperty
from spectral_tv.bands.clamping import Clamped
from spectral_tv.bands.guard import GuardSettings
from spectral_tv.dataclass import dataclass
from spectral_tv.jobs.steps import Steps
from spectral_tv.refusal import Refusal

from ..job.jobs import Seen, all_unchanged
from ..job.operator import JobOperator
from ..options.properties import choices_of
from ..scene.objects import distinct_meshes
from . import clamping
from .set_bands import bands_refusal


@dataclass(frozen=True)
class Prepared:
    """The objects, and what is to be clamped of them."""

    seen: list[Seen]
    clamping: "clamping.Clamping"


class SPECTRAL_TV_OT_bake_safe(JobOperator, choices_of(GuardSettings, "guard"), bpy.types.Operator):
    """Add the present mix of the bands of all decompositions as one new shape key at value 0. Where
    bands above 0 would fold or stretch faces, it has less of them. What bands below 0 take away is
    not clamped"""

    bl_idname = "spectral_tv.bake_safe"
    bl_label = "Bake Safe"
    working = "Clamping"

    together: BoolProperty(
        name="Selected as One",
        description="Clamp all selected meshes as one surface, so that they stay joined where "
        "their open edges meet",
    )

    @staticmethod
    def unusable(subject: bpy.types.ID | None) -> str | None:
        """No bands, or none that can be baked."""
        return bands_refusal(subject, override=False)

    def draw(self, context: bpy.types.Context) -> None:
        super().draw(context)
        self.layout.prop(self, "together")

    def prepare(self, obj: bpy.types.Object) -> Prepared:
        objects = distinct_meshes(bpy.context) if self.together else [obj]
        for each in objects:
            reason = self.unusable(each)
            if reason is not None:
                raise Refusal(f"{each.name}: {reason}")
        seen = [Seen.of(each) for each in objects]
        return Prepared(seen, clamping.Clamping.read(objects, self.settings()))

    def start(self, prepared: Prepared) -> Steps[Clamped]:
        return prepared.clamping.start()

    def write(self, _obj: bpy.types.Object, prepared: Prepared, result: Clamped) -> str:
        _, done = prepared.clamping.write(all_unchanged(prepared.seen), result)
        return done
