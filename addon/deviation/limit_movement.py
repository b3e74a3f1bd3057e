"""The operator that holds a look within a limit."""

import bpy
from spectral_tv.bands.limits import LimitSettings
from spectral_tv.notes import listed, note

from ..bands import limiting
from ..bands.apply_look import note_unsettled, pinned_refusal
from ..bands.set_bands import BandsOperator, bands_refusal
from ..options.properties import choices_of
from ..scene import lengths
from ..scene.modifiers import between
from ..scene.records import all_bands_of, records_of


class SPECTRAL_TV_OT_limit_movement(
    BandsOperator, choices_of(LimitSettings, "limit"), bpy.types.Operator
):
    """Hold the bands of all decompositions back where they move a vertex by more than a limit, at
    their present values. The share of each vertex is a mask of the bands. A limit of 0 takes that
    mask away again"""

    bl_idname = "spectral_tv.limit_movement"
    bl_label = "Limit Movement"

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return deviation_refusal(context.active_object)

    @classmethod
    def description(cls, _context, properties) -> str:
        if properties.is_property_set("limit") and not properties.limit:
            return "Hold nothing back any more: the bands have the masks that they had before"
        return cls.__doc__

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> str:
        bands, records = all_bands_of(obj), records_of(obj)
        asked = self.settings().limit
        if asked > 0:
            note_unsettled(obj, bands, "held at what they are on this frame")
            names = between(obj)
            if names:
                note(f"it holds before {listed(names)}")
            users = [each.name for each in bpy.data.objects if each.data == obj.data]
            if len(users) > 1:
                note(f"the mesh is shared: it holds for {listed(users)}")
        found = limiting.limit(obj, bands, asked, records)
        if found is None:
            return "nothing is held back"
        return found.told(lengths.told)


def deviation_refusal(obj: bpy.types.Object | None) -> str | None:
    """Why there is no look to hold or to measure, in a sentence for the user; None if there is."""
    return bands_refusal(obj, override=False) or pinned_refusal(obj)


def limit_in_force(obj: bpy.types.Object) -> str:
    """How far bands may move a vertex, as it was limited, for panels; nothing without a limit."""
    limits = [record.limit for record in records_of(obj) if record.limit > 0]
    return lengths.told(max(limits)) if limits else ""
