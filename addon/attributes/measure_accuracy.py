"""The operator that measures how accurate the bands are for the number of steps."""

from dataclasses import replace
from typing import Any

import bpy
import spectral_tv
from bpy.props import BoolProperty, EnumProperty
from spectral_tv.bands.methods import METHODS
from spectral_tv.refusal import Refusal

from ..bands.bands import base_shape, settings_as_taken
from ..bands.properties import DecompositionChoices
from ..bands.shapes import read_surfaces
from ..job.operator import JobOperator
from ..scene.records import record_of
from ..scene.surface import Surface
from . import accuracy

# A surface, and the arguments of spectral_tv.accuracy.
Prepared = tuple[Surface, dict[str, Any]]


class SPECTRAL_TV_OT_measure_accuracy(JobOperator, DecompositionChoices, bpy.types.Operator):
    """Measure how the errors of the bands fall with the number of steps, against a flow with eight
    times as many: as a table, and per vertex as attributes and a color attribute"""

    bl_idname = "spectral_tv.measure_accuracy"
    bl_label = "Measure Accuracy"
    working = "Measuring the accuracy on"

    shown: EnumProperty(
        name="Color", description="Which error is shown in color",
        items=[(short, label, "") for label, _, short in accuracy.ERRORS], default="BANDS"
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
        # All steps are measured, and nothing is limited.
        settings = replace(self.settings(), accuracy=0.0, vertex_group="")
        if not settings.by.takes_steps:
            raise Refusal("this method takes no time steps, so there is nothing to measure")
        if settings.complaint() is not None:
            raise Refusal(settings.complaint())
        surface = read_surfaces([obj], settings, without_bands=True)[0]
        base = base_shape([obj], settings, [surface])
        arguments = settings.arguments(surface.mesh, base)
        del arguments["times"]
        steps = {max(settings.steps // part, 2) for part in (1, 2, 4)}
        return surface, {
            **arguments,
            "steps": sorted(steps),
            "bands": settings.bands,
            "scales": settings.scales(surface.mesh),
            "keep_limbs": settings.limbs_kept,
        }

    def start(self, prepared: Prepared) -> spectral_tv.Job:
        surface, arguments = prepared
        return spectral_tv.start_accuracy(surface.mesh, **arguments)

    def write(self, obj: bpy.types.Object, prepared: Prepared, result: spectral_tv.Accuracy) -> str:
        surface, _ = prepared
        names = accuracy.write(obj, METHODS[self.method].label, surface, result, self.shown)
        rows = accuracy.summary(obj.data.spectral_tv.accuracy.as_string())[1:]
        parts = [
            f"{steps} steps: bands {bands}, paper's all-pass {paper}"
            for steps, bands, paper in rows
        ]
        return f"{'; '.join(parts)}; shown as {names[-1]!r}, measured"

    columns = ("method",)

    def draw(self, context: bpy.types.Context) -> None:
        super().draw(context)
        self.layout.prop(self, "shown")
