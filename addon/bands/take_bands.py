"""The operator that replaces bands of a mesh by those of another mesh."""

import bpy
import numpy as np
from bpy.props import IntProperty
from spectral_tv.refusal import Refusal

from ..scene import results
from ..scene.contents import topology_digest
from ..scene.records import bands_of, keeping_of, record_of
from ..scene.results import Piece
from ..scene.whole import whole
from .bands import set_values
from .set_bands import BandsOperator, bands_refusal

# What results are of: bands by their numbers.
KIND = "TAKEN"


class SPECTRAL_TV_OT_take_bands(BandsOperator, bpy.types.Operator):
    """Replace the chosen bands of the active object by those of the other selected object, such
    as the skin of a scan by that of another. Both need the same vertices and as many bands"""

    bl_idname = "spectral_tv.take_bands"
    bl_label = "Take Bands from Selected"
    changes_keys = True

    first: IntProperty(name="From", description="First band; 1 is the finest", default=1, min=1)
    last: IntProperty(name="To", description="Last band; 1 is the finest", default=2, min=1)

    def change(self, context: bpy.types.Context, obj: bpy.types.Object) -> str:
        source = _other(context)
        taken = self._take(obj, source)
        return f"{taken} bands of {source.name} in place of its own"

    def _take(self, obj: bpy.types.Object, source: bpy.types.Object) -> int:
        reason = bands_refusal(source)
        if reason is not None:
            raise Refusal(f"{source.name} has no bands to take: {reason}")
        own, others = bands_of(obj), bands_of(source)
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
        displacement = keeping_of(record_of(source)).displacement
        names = []
        with whole(obj):
            for band in chosen:
                piece = Piece("KEY", displacement(others[band]) @ turn.T)
                taken = {f"{source.name} {others[band].name}": piece}
                # One that was taken in its place before goes.
                names += results.write(
                    obj,
                    KIND,
                    str(band + 1),
                    taken,
                    lambda _: True,
                    lambda _source, label: (label, ""),
                )
        for name, band in zip(names, chosen, strict=True):
            key = obj.data.shape_keys.key_blocks[name]
            # Where the band is masked, it stays, and nothing takes its place.
            key.value, key.vertex_group = 1.0, own[band].vertex_group
        values = [key.value if key is not None else 0.0 for key in own]
        for band in chosen:
            values[band] = -1.0
        set_values(obj, values)
        return len(names)


def _other(context: bpy.types.Context) -> bpy.types.Object:
    others = [obj for obj in context.selected_objects if obj != context.active_object]
    if len(others) != 1:
        raise Refusal("select the one object whose bands it takes, and then this one")
    return others[0]
