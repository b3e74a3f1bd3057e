"""The operator that blurs the mask of a band: its weights flow on the surface as heat does."""

import bpy
import spectral_tv
from spectral_tv.dataclass import dataclass
from spectral_tv.later import np
from spectral_tv.options.declaring import number
from spectral_tv.refusal import Refusal

from ..job.operator import JobOperator
from ..options.properties import choices_of
from ..scene import masks, mix
from ..scene.records import all_bands_of, record_of
from ..scene.surface import Reading, Surface
from .bands import settings_of
from .mask_operators import band_number, masked_band
from .set_bands import bands_refusal

# Equal steps of the flow; more of them change no weight by 1 %.
STEPS = 4


@dataclass(frozen=True)
class BlurSettings:
    """How far."""

    radius: float = number(
        "Radius",
        "How far weights spread on the surface, relative to the object's size: so far from a "
        "straight border 8 % of the mask are left", 2, 0.01, 100, soft_most=20,
        unit="PERCENTAGE", digits=2, place="blur"
    )  # fmt: skip


@dataclass(frozen=True)
class Prepared:
    """The name of a band, the weights of its mask, and the surface that they are on."""

    band: str
    weights: "np.ndarray"
    surface: Surface


class SPECTRAL_TV_OT_blur_mask(JobOperator, choices_of(BlurSettings, "blur"), bpy.types.Operator):
    """Blur the mask of the band along the surface, so that its borders are soft"""

    bl_idname = "spectral_tv.blur_mask"
    bl_label = "Blur Mask"
    working = "Blurring a mask of"

    band: band_number()

    @staticmethod
    def unusable(subject: bpy.types.ID | None) -> str | None:
        """No bands, or none that can be masked."""
        return bands_refusal(subject, override=False)

    def draw(self, context: bpy.types.Context) -> None:
        super().draw(context)
        self.layout.prop(self, "band")

    def prepare(self, obj: bpy.types.Object) -> Prepared:
        band = masked_band(obj, self.band)
        weights = masks.weights(obj, band)
        if np.ptp(weights) == 0:
            raise Refusal(f"the mask of {band.name!r} is {weights[0]:.3g} everywhere")
        made_by = settings_of(record_of(obj))
        reading = Reading(made_by.weld, made_by.leaves_out)
        surface = Surface.read(obj, mix.shown(obj), reading)
        return Prepared(band.name, weights, surface)

    def start(self, prepared: Prepared) -> spectral_tv.Job:
        mesh = prepared.surface.mesh
        # Heat makes a straight border the error function of the distance / (2 √time).
        time = (self.radius / 100) ** 2 * mesh.area / 4
        values = prepared.surface.merge(prepared.weights[:, np.newaxis])
        return spectral_tv.start_flow(mesh, values, np.linspace(0, time, STEPS + 1), "heat")

    def write(self, obj: bpy.types.Object, prepared: Prepared, result: spectral_tv.Flow) -> str:
        band = next((each for each in all_bands_of(obj) if each.name == prepared.band), None)
        if band is None or not np.array_equal(masks.weights(obj, band), prepared.weights):
            raise Refusal("nothing was written, as the mask changed in the meantime")
        surface = prepared.surface
        blurred = surface.to_vertices(result.states[-1][:, 0])
        # What is left out of the surface keeps its weight.
        found = np.where(surface.place >= 0, blurred, prepared.weights)
        group = masks.give(obj, band, found)
        length = self.radius / 100 * np.sqrt(surface.mesh.area)
        return f"the mask {group.name!r} blurred by {length:.3g}"
