"""The list of the decompositions of an object, and what those that are not active do."""

import bpy
from spectral_tv.bands.methods import METHODS

from ..drawing.sidebar import say
from ..scene.decomposition import SpectralTVRecord
from ..scene.objects import user_of
from ..scene.records import records_of
from . import acting
from .list_operators import (
    SPECTRAL_TV_OT_remove_decomposition,
    SPECTRAL_TV_OT_switch_decomposition,
)

MOST_ROWS = 5


class SPECTRAL_TV_UL_decompositions(bpy.types.UIList):
    """A name, which a double click changes; method, number of bands, and whether they act."""

    def draw_item(
        self,
        _context: bpy.types.Context,
        layout: bpy.types.UILayout,
        _data: bpy.types.PropertyGroup,
        item: SpectralTVRecord,
        _icon: int,
        _active_data: bpy.types.PropertyGroup,
        _active_name: str,
    ) -> None:
        obj = user_of(item.id_data)
        row = layout.row(align=True)
        is_there = item in records_of(obj)
        icon = acting.State.of(obj, item).icon if is_there else "ERROR"
        row.prop(item, "name", text="", emboss=False, icon=icon)
        right = row.row()
        right.alignment = "RIGHT"
        label = METHODS[item.method].label if item.method in METHODS else item.method
        count = len(item.bands)
        # Most are called by their method, or by a recipe that says more.
        is_told = item.name.startswith(label) or item.recipe
        right.label(text=f"{count} bands" if is_told else f"{label} · {count}")


def draw(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw the list, and below it a line and a button for each other one that is not at rest."""
    obj = context.active_object
    kept = obj.data.spectral_tv
    if len(kept.decompositions) > 0:
        row = layout.row()
        row.template_list(
            SPECTRAL_TV_UL_decompositions.__name__, "", kept, "decompositions", kept,
            "active_decomposition", rows=min(len(kept.decompositions), MOST_ROWS),
            maxrows=MOST_ROWS, sort_lock=True,
        )  # fmt: skip
        row.operator(SPECTRAL_TV_OT_remove_decomposition.bl_idname, text="", icon="REMOVE")
    for record, state in acting.others_acting(obj):
        column = layout.column(align=True)
        say(column, context, f"{record.name} {state.told()}", state.icon)
        button = column.operator(
            SPECTRAL_TV_OT_switch_decomposition.bl_idname, text=f"Switch to {record.name}"
        )
        button.name = record.name
