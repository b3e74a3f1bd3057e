"""The operator that splits the active mesh into bands."""

import time

import bpy
import spectral_tv
from bpy.props import EnumProperty, IntProperty

from ..objects import Refusal, refusal
from ..shape_keys import add_displacements
from ..surface import Surface
from ._progress import cursor_progress

METHODS = (
    ("M1", "Shape Detail", "M1, shape spectral TV: surface detail at every size"),
    ("M2", "Limbs and Head", "M2, conformalized 3-Laplace: limbs, head and other extremities"),
    ("M3", "Edge-Keeping Detail", "M3, directional TV on a smooth base: detail with crisp edges"),
    ("NAIVE", "Per Axis", "TV of each coordinate alone: squares the shape along its axes"),
    ("HEAT", "Heat", "Linear diffusion, for comparison"),
)


class SPECTRAL_TV_OT_decompose(bpy.types.Operator):
    """Split the active mesh into bands of detail, one shape key per band"""

    bl_idname = "spectral_tv.decompose"
    bl_label = "Decompose into Bands"
    bl_options = {"REGISTER", "UNDO"}

    method: EnumProperty(name="Method", items=METHODS, default="M1")
    bands: IntProperty(
        name="Bands",
        description="Number of bands, from the finest detail to the largest",
        default=5,
        min=1,
        max=32,
    )
    steps: IntProperty(
        name="Steps",
        description="Number of time steps of the flow: more separate scales more sharply",
        default=32,
        min=2,
        soft_max=128,
        max=1000,
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        reason = refusal(context.active_object)
        if reason is not None:
            cls.poll_message_set(reason)
        return reason is None

    def execute(self, context: bpy.types.Context) -> set[str]:
        started = time.perf_counter()
        obj = context.active_object
        try:
            bands = self._decompose(context, Surface.read(obj))
        except (spectral_tv.MeshError, Refusal) as error:
            self.report({"ERROR"}, f"{obj.name}: {error}")
            return {"CANCELLED"}
        names = [f"{self.method.title()} Band {band + 1}" for band in range(self.bands)]
        add_displacements(obj, names, bands)
        seconds = time.perf_counter() - started
        message = f"{obj.name}: {self.bands} bands of {self.method} added in {seconds:.1f} s"
        if obj.data.users > 1:
            message += f"; {obj.data.users} objects share this mesh and its shape keys"
        self.report({"INFO"}, message)
        return {"FINISHED"}

    def _decompose(self, context: bpy.types.Context, surface: Surface):
        """Return the displacement of every band in object space, (K, V, 3)."""
        if self.bands >= self.steps:
            raise Refusal(f"{self.bands} bands need more than {self.steps} steps")
        with cursor_progress(context) as progress:
            split = spectral_tv.decompose(
                surface.mesh, method=self.method.lower(), steps=self.steps, progress=progress
            )
        return surface.to_object(split.bands(split.band_edges(self.bands)))
