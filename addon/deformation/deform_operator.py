"""The operator that deforms the active mesh by its constraints."""

from typing import Any

import bpy
import spectral_tv

from ..job.operator import JobOperator
from .constraints import DeformationChoices, deformation_of
from .deform import Deformable, deform_refusal, message, prepare, write

# What was read of the object, and the arguments of spectral_tv.deform.
Prepared = tuple[Deformable, dict[str, Any]]


class SPECTRAL_TV_OT_deform(JobOperator, DeformationChoices, bpy.types.Operator):
    """Move the constrained vertices where they belong, and have the others follow in rigid
    pieces. Writes one shape key; deforming again overwrites it"""

    bl_idname = "spectral_tv.deform"
    bl_label = "Deform"
    working = "Deforming"

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return deform_refusal(context.active_object)

    def prepare(self, obj: bpy.types.Object) -> Prepared:
        for name in DeformationChoices.__annotations__:
            if not self.properties.is_property_set(name):
                setattr(self, name, getattr(deformation_of(obj), name))
        return prepare(obj, self.algorithm, self.softness)

    def start(self, prepared: Prepared) -> spectral_tv.Job:
        deformable, arguments = prepared
        return spectral_tv.start_deform(deformable.surface.mesh, **arguments)

    def write(
        self, obj: bpy.types.Object, prepared: Prepared, result: spectral_tv.Deformation
    ) -> str:
        deformable, _ = prepared
        write(obj, deformable.displacement(result))
        return message(result, self.algorithm)
