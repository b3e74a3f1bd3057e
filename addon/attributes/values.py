"""Operators that show the values of vertices and groups over time: as table, picture and file."""

from pathlib import Path

import bpy
import spectral_tv
from bpy.props import StringProperty
from bpy_extras.io_utils import ExportHelper
from spectral_tv.dataclass import dataclass
from spectral_tv.files import whole
from spectral_tv.later import np
from spectral_tv.refusal import Refusal

from ..job.operator import JobOperator
from . import curves, flows
from .properties import MeasureChoices


@dataclass(frozen=True)
class Prepared:
    """A function to be flowed, and the weights of what is measured, by name."""

    function: "flows.Prepared"
    parts: "dict[str, np.ndarray]"


class SPECTRAL_TV_OT_plot_values(JobOperator, MeasureChoices, bpy.types.Operator):
    """Flow to the chosen size, and tell the mean values of vertex groups, or those of single
    vertices, at all times: as a text, and as an image of the curves"""

    bl_idname = "spectral_tv.plot_values"
    bl_label = "Plot Values"
    working = "Flowing on"

    filepath: StringProperty(
        name="File", description="Write the table to this file too", subtype="FILE_PATH"
    )

    def prepare(self, obj: bpy.types.Object) -> Prepared:
        self.result = "FLOW"
        function = flows.prepare(obj, self.settings(), is_even=True)
        return Prepared(function, curves.parts(obj, self.parts, self.groups))

    def start(self, prepared: Prepared) -> spectral_tv.Job:
        return spectral_tv.start_flow(prepared.function.surface.mesh, **prepared.function.arguments)

    def write(self, obj: bpy.types.Object, prepared: Prepared, result: spectral_tv.Flow) -> str:
        table = curves.table(prepared.function, prepared.parts, result)
        if self.filepath:  # first, as it may be refused
            save(self.filepath, table.text())
        curves.write(obj, f"{prepared.function.source.name} Values", table)
        kept = obj.data.spectral_tv
        count = len(table.names)
        return f"{count} curves in the text {kept.table.name!r} and the image {kept.picture.name!r}"

    def draw(self, _context: bpy.types.Context) -> None:
        """Lay out Adjust Last Operation."""
        self.layout.use_property_split = True
        for name in ("kind", "source", "size", "law", "steps", "parts", "groups"):
            self.layout.prop(self, name)


class SPECTRAL_TV_OT_export_values(ExportHelper, bpy.types.Operator):
    """Write the table of the values last plotted to a file"""

    bl_idname = "spectral_tv.export_values"
    bl_label = "Export Table"

    filename_ext = ".csv"
    filter_glob: StringProperty(
        name="Filter", description="Which files are shown", default="*.csv", options={"HIDDEN"}
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        obj = context.active_object
        if obj is not None and obj.type == "MESH" and obj.data.spectral_tv.table is not None:
            return True
        cls.poll_message_set("Plot values first")
        return False

    def execute(self, context: bpy.types.Context) -> set[str]:
        text = context.active_object.data.spectral_tv.table.as_string()
        try:
            save(self.filepath, text)
        except Refusal as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, f"Wrote {self.filepath}")
        return {"FINISHED"}


def save(path: str, text: str) -> None:
    """Write a text to a file, // being the folder of the .blend; raises Refusal if it cannot."""
    try:
        whole.write_text(Path(bpy.path.abspath(path)), text)
    except whole.NotWritten as error:
        raise Refusal(str(error)) from error
