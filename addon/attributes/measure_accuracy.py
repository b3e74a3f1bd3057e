"""The operator that measures how accurate the bands are for the number of steps."""

from collections.abc import Mapping
from typing import Any

import bpy
import spectral_tv
from bpy.props import BoolProperty, EnumProperty
from spectral_tv.attributes.accuracy import ERRORS, arguments, measured, told
from spectral_tv.bands.methods import METHODS
from spectral_tv.refusal import Refusal

from ..bands import shapes
from ..bands.bands import base_shape, settings_as_taken
from ..bands.properties import DecompositionChoices
from ..job.operator import JobOperator
from ..scene.records import record_of
from ..scene.surface import Surface
from . import accuracy

# A surface, and the arguments of spectral_tv.accuracy.
Prepared = tuple[Surface, Mapping[str, Any]]


class SPECTRAL_TV_OT_measure_accuracy(JobOperator, DecompositionChoices, bpy.types.Operator):
    """Measure how the errors of the bands fall with the number of steps, against a flow with eight
    times as many: as a table, and per vertex as attributes and a color attribute"""

    bl_idname = "spectral_tv.measure_accuracy"
    bl_label = "Measure Accuracy"
    working = "Measuring the accuracy on"

    shown: EnumProperty(
        name="Color", description="Which error is shown in color",
        items=[(short, label, "") for label, _, short in ERRORS], default="BANDS"
    )  # fmt: skip

    of_bands: BoolProperty(
        name="Of the Bands",
        description="Measure by the settings that the object's bands were made by, whatever the "
        "others say", options={"SKIP_SAVE"}
    )  # fmt: skip

    def prepare(self, obj: bpy.types.Object) -> Prepared:
        if self.of_bands:
            record = record_of(obj)
            if record is None:
                raise Refusal("it has no bands; decompose it first")
            self.fill(settings_as_taken(record))
            self.of_bands = False  # what is adjusted afterwards counts
        settings = measured(self.settings())
        surface = shapes.read_surfaces([obj], settings, without_bands=True)[0]
        base = base_shape([obj], settings, [surface])
        return surface, arguments(settings, surface.mesh, base)

    def start(self, prepared: Prepared) -> spectral_tv.Job:
        surface, arguments = prepared
        return spectral_tv.start_accuracy(surface.mesh, **arguments)

    def write(
        self, obj: bpy.types.Object, prepared: Prepared, result: "spectral_tv.Accuracy"
    ) -> str:
        surface, _ = prepared
        names = accuracy.write(obj, METHODS[self.method].label, surface, result, self.shown)
        done = told(obj.data.spectral_tv.accuracy.as_string())
        return f"{done}; shown as {names[-1]!r}, measured"

    columns = ("method",)

    def draw(self, context: bpy.types.Context) -> None:
        super().draw(context)
        self.layout.prop(self, "shown")
