"""The operator that measures how far a look is from the original: figures, and an attribute."""

from pathlib import Path

import bpy
from bpy.props import StringProperty
from spectral_tv.bands.limits import LimitSettings
from spectral_tv.files import whole as files_whole
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

from ..bands import deviation, figures
from ..bands.set_bands import BandsOperator
from ..options.properties import choices_of
from ..scene import results
from ..scene.documents import keep_text
from ..scene.records import all_bands_of
from ..scene.results import Piece
from ..scene.whole import whole
from .limit_movement import deviation_refusal

# The kind of the result, and the name of the attribute.
KIND, NAME = "DEVIATION", "Deviation"


class SPECTRAL_TV_OT_measure_deviation(
    BandsOperator, choices_of(LimitSettings, "limit"), bpy.types.Operator
):
    """Measure how far the bands of all decompositions move the surface: figures as a text of JSON,
    and a float attribute with the length per vertex, negative inwards, in the scene's unit"""

    bl_idname = "spectral_tv.measure_deviation"
    bl_label = "Measure Deviation"

    filepath: StringProperty(
        name="File", description="Write the figures to this file too", subtype="FILE_PATH",
        options={"SKIP_SAVE"}
    )  # fmt: skip

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return deviation_refusal(context.active_object)

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> str:
        bands = all_bands_of(obj)
        found = figures.figures(obj, bands, self.settings().limit)
        text = figures.text_of(found)
        if self.filepath:  # first, as it may be refused
            try:
                files_whole.write_text(Path(bpy.path.abspath(self.filepath)), text)
            except files_whole.NotWritten as error:
                raise Refusal(str(error)) from error
        signed = deviation.Deviation.of(obj, bands).signed
        piece = Piece("ATTRIBUTE", np.asarray(signed)[:, np.newaxis], "FLOAT")
        with whole(obj):
            kept = keep_text(obj.data, "deviation", f"{obj.name} Deviation.json", text)
            (name,) = results.write(
                obj, KIND, "", {NAME: piece}, wanted=lambda _source, label: (label, "")
            )
        return f"{figures.told(found)}; the text {kept.name!r} and the attribute {name!r} have it"

    def draw(self, context: bpy.types.Context) -> None:
        super().draw(context)
        self.layout.prop(self, "filepath")
