"""The operator that splits the active mesh into bands."""

from collections.abc import Callable
from typing import Any

import bpy
import spectral_tv

from ..decomposition.bands import add_bands, prepare, recall
from ..decomposition.properties import DecompositionProperties, draw_method
from ..decomposition.settings import key_label
from ..scene.surface import Surface
from ._job import JobOperator

# A surface, and the arguments of spectral_tv.decompose.
Prepared = tuple[Surface, dict[str, Any]]


class SPECTRAL_TV_OT_decompose(JobOperator, DecompositionProperties, bpy.types.Operator):
    """Split the active mesh into bands of detail, one shape key per band"""

    bl_idname = "spectral_tv.decompose"
    bl_label = "Decompose into Bands"
    bl_options = {"REGISTER", "UNDO"}
    working = "Decomposing"

    def prepare(self, obj: bpy.types.Object) -> Prepared:
        return prepare(obj, self.settings())

    def recall(self, prepared: Prepared) -> spectral_tv.Decomposition | None:
        return recall(*prepared)

    def work(
        self, prepared: Prepared, progress: Callable[[float], None]
    ) -> spectral_tv.Decomposition:
        surface, arguments = prepared
        return spectral_tv.decompose(surface.mesh, **arguments, progress=progress)

    def start(self, prepared: Prepared) -> spectral_tv.Job:
        surface, arguments = prepared
        return spectral_tv.start_decompose(surface.mesh, **arguments)

    def write(
        self, obj: bpy.types.Object, prepared: Prepared, result: spectral_tv.Decomposition
    ) -> str:
        surface, arguments = prepared
        names = add_bands(obj, self.settings(), surface, arguments, result)
        bands = "1 band" if len(names) == 1 else f"{len(names)} bands"
        return f"{bands} of {key_label(self.method)} added"

    def draw(self, _context: bpy.types.Context) -> None:
        """Lay out Adjust Last Operation."""
        layout = self.layout
        layout.use_property_split = True
        draw_method(self, layout)


CLASSES = (SPECTRAL_TV_OT_decompose,)
