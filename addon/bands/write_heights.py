"""The operator that writes the heights of bands as attributes."""

import bpy
from spectral_tv.notes import listed

from ..scene.records import record_of
from . import heights
from .set_bands import BandsOperator


class SPECTRAL_TV_OT_write_heights(BandsOperator, bpy.types.Operator):
    """Write how far each active band moves the surface outwards, as attributes for masks and
    shading. Inwards is negative. Again to write it anew"""

    bl_idname = "spectral_tv.write_heights"
    bl_label = "Write Heights"
    changes_keys = True

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> str:
        return f"its bands' heights are {listed(heights.write(obj, record_of(obj)))}"
