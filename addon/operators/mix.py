"""The operator that puts the detail of one mesh onto another."""

import bpy
import numpy as np
from bpy.props import IntProperty

from ..scene.objects import Refusal
from ..scene.records import band_keys, coordinates, record_of, topology_digest
from ..scene.shape_keys import add_displacements
from ..scene.surface import basis_coordinates
from .filter import BandsOperator, bands_refusal


class SPECTRAL_TV_OT_take_bands(BandsOperator, bpy.types.Operator):
    """Replace the chosen bands of the active object by those of the other selected object, such
    as the skin of a scan by that of another. Both need the same vertices and as many bands"""

    bl_idname = "spectral_tv.take_bands"
    bl_label = "Take Bands from Selected"
    changes_keys = True

    first: IntProperty(name="From", description="First band; 1 is the finest", default=1, min=1)
    last: IntProperty(name="To", description="Last band; 1 is the finest", default=2, min=1)

    def execute(self, context: bpy.types.Context) -> set[str]:
        obj = context.active_object
        try:
            source = _other(context)
            taken = self._take(obj, source)
        except Refusal as error:
            self.report({"ERROR"}, f"{obj.name}: {error}")
            return {"CANCELLED"}
        self.report({"INFO"}, f"{obj.name}: {taken} bands of {source.name} in place of its own")
        return {"FINISHED"}

    def _take(self, obj: bpy.types.Object, source: bpy.types.Object) -> int:
        reason = bands_refusal(source)
        if reason is not None:
            raise Refusal(f"{source.name} has no bands to take: {reason}")
        own, others = band_keys(obj), band_keys(source)
        if len(own) != len(others):
            raise Refusal(f"it has {len(own)} bands, but {source.name} has {len(others)}")
        if topology_digest(obj.data) != topology_digest(source.data):
            raise Refusal(f"{source.name} has other vertices or faces")
        first, last = sorted((self.first, self.last))
        chosen = range(first - 1, min(last, len(own)))
        if not chosen:
            raise Refusal(f"it has no band {first}")
        missing = [band + 1 for band in chosen if others[band] is None or own[band] is None]
        if missing:
            raise Refusal(f"band {missing[0]} was deleted")
        # Directions are kept in the world, lengths relative to the sizes of the objects.
        turn = np.array(obj.matrix_world.to_3x3().inverted_safe() @ source.matrix_world.to_3x3())
        turn *= np.sqrt(record_of(obj).area / record_of(source).area)
        basis = basis_coordinates(source.data)
        displacements = np.stack(
            [(coordinates(others[band].data).reshape(-1, 3) - basis) @ turn.T for band in chosen]
        )
        names = [f"{source.name} {others[band].name}" for band in chosen]
        for key in add_displacements(obj, names, displacements):
            key.value = 1.0
        for band in chosen:
            own[band].value = -1.0
        return len(names)


def _other(context: bpy.types.Context) -> bpy.types.Object:
    others = [obj for obj in context.selected_objects if obj != context.active_object]
    if len(others) != 1:
        raise Refusal("select the one object whose bands it takes, and then this one")
    return others[0]


CLASSES = (SPECTRAL_TV_OT_take_bands,)
