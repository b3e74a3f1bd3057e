"""The operator that flows an attribute, a vertex group, a color attribute or a shape key."""

import bpy
import spectral_tv

from ..job.operator import JobOperator
from . import flows, outputs
from .properties import AttributeChoices


class SPECTRAL_TV_OT_flow_attribute(JobOperator, AttributeChoices, bpy.types.Operator):
    """Smooth or filter an attribute, a vertex group, a color attribute or a shape key on the
    surface. Writes beside it; running again replaces what was written"""

    bl_idname = "spectral_tv.flow_attribute"
    bl_label = "Flow"
    working = "Flowing on"

    def prepare(self, obj: bpy.types.Object) -> "flows.Prepared":
        return flows.prepare(obj, self.settings())

    def start(self, prepared: "flows.Prepared") -> spectral_tv.Job:
        return spectral_tv.start_flow(prepared.surface.mesh, **prepared.arguments)

    def write(
        self, obj: bpy.types.Object, prepared: "flows.Prepared", result: spectral_tv.Flow
    ) -> str:
        found = flows.results(prepared, self.settings(), result)
        names = outputs.write(obj, prepared.source, found)
        text = f"{prepared.source.name!r} written as {', '.join(map(repr, names))}"
        if prepared.arguments.get("elements") == "edges":
            text += ", flowed on edges"
        if prepared.source.kind == "GROUP" and len(found) == 1:
            (weights,) = found.values()
            cut = int(((weights < -1e-3) | (weights > 1 + 1e-3)).sum())
            if cut:
                text += f", {cut} weights cut off at 0 and 1"
        return text
