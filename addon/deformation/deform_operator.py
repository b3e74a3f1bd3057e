"""The operator that deforms the active mesh by its constraints."""

from typing import TYPE_CHECKING, TypeAlias

import bpy
from spectral_tv.deformation.settings import algorithm_for
from spectral_tv.jobs.steps import Steps
from spectral_tv.later import np

from ..job.operator import JobOperator
from . import deform
from .constraints import DeformationChoices, deformation_of

if TYPE_CHECKING:
    from spectral_tv.deformation.solvers import Solved, Solver

# What was read of the object, the targets of its grips, and what solves for them.
Prepared: TypeAlias = "tuple[deform.Deformable, np.ndarray, Solver]"


class SPECTRAL_TV_OT_deform(JobOperator, DeformationChoices, bpy.types.Operator):
    """Move the constrained vertices where they belong, and have the others follow in rigid
    pieces. Writes one shape key; deforming again overwrites it"""

    bl_idname = "spectral_tv.deform"
    bl_label = "Deform"
    working = "Deforming"

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return deform.deform_refusal(context.active_object)

    def prepare(self, obj: bpy.types.Object) -> Prepared:
        names = DeformationChoices.__annotations__
        given = [name for name in names if self.properties.is_property_set(name)]
        for name in names:
            if name not in given:
                setattr(self, name, getattr(deformation_of(obj), name))
        if "algorithm" not in given:  # an option of one algorithm asks for it
            self.algorithm = algorithm_for(given) or self.algorithm
        return deform.prepare(obj, self.settings())

    def start(self, prepared: Prepared) -> "Steps[Solved]":
        _, targets, solver = prepared
        return solver.start(targets)

    def write(self, obj: bpy.types.Object, prepared: Prepared, solved: "Solved") -> str:
        deformable, _, solver = prepared
        deform.write(obj, deformable.displacement(solved.result))
        return solver.message(solved)
