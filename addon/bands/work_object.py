"""The operator that makes a work object of the top level of a Multiresolution sculpt."""

import bpy
from spectral_tv.notes import note

from ..job.operator import ChangeOperator
from ..scene import multires, work_objects
from ..scene.coordinates import points
from ..scene.objects import refusal, take_place
from ..scene.temporary import Temporary


class SPECTRAL_TV_OT_work_object(ChangeOperator, bpy.types.Operator):
    """Make an object of the top level of the Multiresolution modifier, at rest: one that can be
    decomposed and dialled in full detail. Write Back puts its shape back into the levels. If there
    is such an object of the present levels, show that"""

    bl_idname = "spectral_tv.work_object"
    bl_label = "Work on Top Level"

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return work_refusal(context.active_object)

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> str:
        with Temporary() as now:
            mesh = multires.top_mesh(obj)
            places = points(mesh.vertices)
            there = [each for each in _shown_here(obj) if work_objects.is_as_seen(each, places)]
            if there:
                now.made(mesh)
                there[0].hide_set(False)
                take_place(there[0], obj)
                return f"{there[0].name!r} has its top level"
        old = [each.name for each in _shown_here(obj)]
        if old:
            note(f"{', '.join(old)} stays: it is of what the levels were before")
        work = work_objects.make(obj, mesh)
        take_place(work, obj)
        return f"{work.name!r} is its top level at rest, {len(mesh.vertices)} vertices"


def work_refusal(obj: bpy.types.Object | None) -> str | None:
    """Why there can be no work object, in a sentence for the user; None if there can be."""
    return refusal(obj) or multires.levels_refusal(obj)


def _shown_here(obj: bpy.types.Object) -> list[bpy.types.Object]:
    """The work objects of ``obj`` that can be shown in the present view layer."""
    there = bpy.context.view_layer.objects
    return [each for each in work_objects.works_of(obj) if there.get(each.name) == each]
