"""The operator that measures how thick a mesh is."""

from __future__ import annotations

import bpy
import spectral_tv
from spectral_tv.later import np

from ..job.operator import JobOperator
from ..scene import mix, results
from ..scene.results import Piece
from ..scene.surface import Surface

# The kind of the result, and the name of the attribute.
KIND, NAME = "THICKNESS", "Thickness"


class SPECTRAL_TV_OT_measure_thickness(JobOperator, bpy.types.Operator):
    """Measure at every vertex how thick the shape is as it is shown, as a float attribute: the
    radius of the largest ball inside that reaches it, in the scene's unit. Keep Limbs goes by it"""

    bl_idname = "spectral_tv.measure_thickness"
    bl_label = "Measure Thickness"
    working = "Measuring the thickness of"

    def prepare(self, obj: bpy.types.Object) -> Surface:
        return Surface.read(obj, mix.shown(obj))

    def start(self, prepared: Surface) -> spectral_tv.Job:
        return spectral_tv.start_thickness(prepared.mesh)

    def write(self, obj: bpy.types.Object, prepared: Surface, result: np.ndarray) -> str:
        piece = Piece("ATTRIBUTE", prepared.to_vertices(result)[:, np.newaxis], "FLOAT")
        (name,) = results.write(
            obj, KIND, "", {NAME: piece}, wanted=lambda _source, label: (label, "")
        )
        used = result[result > 0]
        if not len(used):
            return f"{name!r} is 0 everywhere; measured"
        return f"{name!r} is from {used.min():.3g} to {used.max():.3g}; measured"
