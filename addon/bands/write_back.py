"""The operator that puts the shape of a work object back into the levels of its source."""

import bpy
from spectral_tv.later import np
from spectral_tv.notes import note
from spectral_tv.refusal import Refusal

from ..job.operator import ChangeOperator
from ..scene import applied, multires, work_objects
from ..scene.objects import refusal, take_place
from ..scene.places import is_kept_up
from ..scene.temporary import Temporary
from . import original

# So far apart, relative to what they are, are transforms that differ.
MOVED = 1e-5


class SPECTRAL_TV_OT_write_back(ChangeOperator, bpy.types.Operator):
    """Give the top level of the source the shape that this work object shows. The levels below
    follow; the base mesh, shape keys, masks and UV maps stay. The source is shown again, and this
    object is kept, hidden"""

    bl_idname = "spectral_tv.write_back"
    bl_label = "Write Back"

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return write_refusal(context.active_object)

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> str:
        source = obj.spectral_tv_work.source
        given = write_back(obj)
        if bpy.context.view_layer.objects.get(source.name) == source:
            source.hide_set(False)
            take_place(source, obj)
        else:
            note(f"{source.name!r} is not in this view layer, so it is not shown")
        return (
            f"the top level of {source.name!r} has its shape, to within {given.farthest:.1g} of "
            "the size"
        )


def write_refusal(obj: bpy.types.Object | None) -> str | None:
    """Why nothing can be written back, in a sentence for the user; None if it can be."""
    reason = refusal(obj)
    if reason is not None:
        return reason
    if not work_objects.is_work(obj):
        return "The object is no work object of a Multiresolution sculpt"
    if obj.mode != "OBJECT":
        return "Go to Object Mode first"
    if original.is_shown(obj):
        return original.REASON
    return work_objects.source_refusal(obj)


def write_back(work: bpy.types.Object) -> multires.Given:
    """Put the shape that is shown of a work object into the levels of its source.

    Raises Refusal if it does not fit; then nothing was changed.
    """
    source = work.spectral_tv_work.source
    if not is_kept_up(work):
        raise Refusal("it is hidden, so that Blender does not work out its shape; show it")
    with Temporary() as now:
        given = multires.give(source, now.made(applied.mesh_of(work)))
    if not work_objects.is_as_seen(work, given.before):
        note(
            f"{source.name!r} was sculpted since this was made or written back; what was sculpted "
            "there is written over"
        )
    _tell(work, source)
    work_objects.remember(work, source, given.after)
    return given


def _tell(work: bpy.types.Object, source: bpy.types.Object) -> None:
    """Note what is not what it looks like."""
    places = [np.array(each.matrix_world) for each in (work, source)]
    if not np.allclose(*places, rtol=MOVED, atol=MOVED * np.abs(places).max()):
        note(f"how it was moved, turned or scaled beside {source.name!r} is not written back")
    if source.data.users > 1:
        note(f"{source.data.users} objects share the mesh of {source.name!r}, and have the shape")
