"""The panel of the bands: the spectrum, a slider per band, filters."""

import math

import bpy
from spectral_tv.bands.gains import PRESETS

from ..drawing.preferences import shows_research
from ..drawing.sidebar import Sidebar, say
from ..scene import keeping, lengths
from ..scene.attribute_band import modifiers_of
from ..scene.decomposition import SpectralTVRecord
from ..scene.modifiers import ahead_of_bands
from ..scene.records import bands_shown, record_of, records_of, topology_changed
from . import (
    convert,
    count,
    curve_watch,
    filter_curve,
    list_panel,
    live_guard,
    mask_menu,
    original,
    remarks,
    sliders,
    spectrum,
)
from . import set_bands as operators
from .apply_look import SPECTRAL_TV_OT_apply_look
from .apply_modifier import SPECTRAL_TV_OT_apply_modifier, appliable, apply_refusal
from .bake_safe import SPECTRAL_TV_OT_bake_safe
from .bands import flows
from .carry_along import SPECTRAL_TV_OT_carry_along
from .refit_armature import SPECTRAL_TV_OT_refit_armature
from .show_original import SPECTRAL_TV_OT_show_original
from .take_bands import SPECTRAL_TV_OT_take_bands, take_all
from .write_heights import SPECTRAL_TV_OT_write_heights


class BandsPanel(Sidebar):
    """A sub-panel, shown once the active object has bands that still fit its mesh."""

    bl_parent_id = "SPECTRAL_TV_PT_bands"
    bl_options = {"DEFAULT_CLOSED"}
    is_split = False

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        obj = context.active_object
        return record_of(obj) is not None and not topology_changed(obj)


class SPECTRAL_TV_PT_bands(Sidebar, bpy.types.Panel):
    """The bands of the active object"""

    bl_label = "Bands"
    is_split = False

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return record_of(context.active_object) is not None

    def rows(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        obj = context.active_object
        record = record_of(obj)
        list_panel.draw(layout, context)
        if topology_changed(obj):
            text = "Vertices or faces changed since. Decompose the mesh again"
            say(layout, context, text, "ERROR")
            return
        self._draw_modifiers(layout, context)
        self._draw_spectrum(layout, record)
        is_original = original.is_shown(obj)
        # Above the sliders, so that it stays under the mouse whatever their number is.
        row = layout.row()
        row.enabled = operators.cut_refusal(obj) is None
        row.prop(obj.data.spectral_tv_count, "bands")
        remarks.draw(layout, context, obj.data, "count", count.state(record))
        if is_original:
            text = "The original is shown; the values of the bands are kept"
            say(layout.box(), context, text, "INFO")
        layout.operator(
            SPECTRAL_TV_OT_show_original.bl_idname,
            text="Show Look" if is_original else "Show Original",
            icon="LOOP_BACK" if is_original else "LOOP_FORWARDS",
            depress=is_original,
        )
        column = layout.column(align=True)
        column.enabled = not is_original
        sliders.draw_scale(column, bands_shown(obj), icons=4)
        for number, key in enumerate(bands_shown(obj), start=1):
            row = column.row(align=True)
            row.label(text="", icon_value=spectrum.swatch(number - 1, len(record.bands)))
            if key is None:
                row.label(text=f"Band {number} was deleted")
                continue
            place = keeping.place_of(key)
            label = key.name.removeprefix(f"{record.name} ")
            place.draw(row, key, "value", text=label, slider=True)
            mask_menu.draw(row, obj, record, number)
            place.draw(row, key, "mute", text="", icon="HIDE_ON" if key.mute else "HIDE_OFF")
            icon = "SOLO_ON" if number == record.solo else "SOLO_OFF"
            solo = row.operator(operators.SPECTRAL_TV_OT_solo.bl_idname, text="", icon=icon)
            solo.band = number
        self._draw_limbs(layout, context, record)
        live_guard.draw(layout, context)
        layout.operator(operators.SPECTRAL_TV_OT_keyframe.bl_idname, icon="KEY_HLT")
        row = layout.row(align=True)
        row.operator(operators.SPECTRAL_TV_OT_bake.bl_idname, icon="SHAPEKEY_DATA")
        row.operator(SPECTRAL_TV_OT_bake_safe.bl_idname, icon="FAKE_USER_ON")
        row = layout.row(align=True)
        row.operator(SPECTRAL_TV_OT_apply_look.bl_idname, icon="CHECKMARK").place = "HERE"
        row.operator(SPECTRAL_TV_OT_apply_look.bl_idname, text="", icon="DUPLICATE").place = "COPY"
        row = layout.row(align=True)
        row.operator(operators.SPECTRAL_TV_OT_copy_filter.bl_idname, icon="COPYDOWN")
        row.operator(SPECTRAL_TV_OT_write_heights.bl_idname, text="", icon="IPO_BACK")
        convert.draw(row, context)
        row = layout.row(align=True)
        row.operator(SPECTRAL_TV_OT_carry_along.bl_idname, icon="LINKED")
        row.operator(SPECTRAL_TV_OT_refit_armature.bl_idname, icon="ARMATURE_DATA")

    @staticmethod
    def _draw_modifiers(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
        """Draw what keeps bands that are attributes from being seen as they should."""
        obj = context.active_object
        off = [each.name for each in modifiers_of(obj) if not each.show_viewport]
        if off:
            text = f"Off in the viewport, with its bands: {', '.join(off)}"
            say(layout, context, text, "ERROR")
        ahead = ahead_of_bands(obj)
        if ahead:
            text = f"Before the bands, which act at rest no more: {', '.join(ahead)}"
            say(layout, context, text, "ERROR")

    @staticmethod
    def _draw_limbs(
        layout: bpy.types.UILayout, context: bpy.types.Context, record: SpectralTVRecord
    ) -> None:
        obj = context.active_object
        reason = operators.cut_refusal(obj)
        row = layout.row()
        row.enabled = reason is None
        row.prop(obj.data.spectral_tv_limbs, "keep", slider=True)
        if reason is not None and record.identifier not in flows:
            say(layout, context, f"{reason} to change it or the number of bands", "INFO")
        sculpted = [band.key for band in record.bands if band.is_sculpted]
        if sculpted:
            verb = "was sculpted and stays" if len(sculpted) == 1 else "were sculpted and stay"
            say(layout, context, f"{', '.join(sculpted)} {verb}", "INFO")

    @staticmethod
    def _draw_spectrum(layout: bpy.types.UILayout, record: SpectralTVRecord) -> None:
        if not shows_research():
            ends = record.kept_spectrum[0, 0], record.bands[-1].end
            layout.label(text=" to ".join(_length(end) for end in ends), icon="ARROW_LEFTRIGHT")
            return
        row = layout.split(factor=0.66)
        row.template_icon(spectrum.icon(record), scale=7.6)
        column = row.column(align=True)
        column.label(text="Finest")
        column.label(text=_length(record.kept_spectrum[0, 0]))
        column.separator(factor=3.5)
        column.label(text="Largest")
        column.label(text=_length(record.bands[-1].end))


def _length(time: float) -> str:
    """The size of the features that vanish at a time, in the units of the scene."""
    return lengths.told(math.sqrt(time))


class SPECTRAL_TV_PT_filters(BandsPanel, bpy.types.Panel):
    """Common filters"""

    bl_label = "Filters"
    bl_options = set()

    def rows(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        settings = context.scene.spectral_tv_filter
        row = layout.row(align=True)
        row.prop(settings, "first")
        row.prop(settings, "last")
        layout.prop(settings, "amount")
        grid = layout.grid_flow(columns=2, row_major=True, align=True, even_columns=True)
        several = len(records_of(context.active_object)) > 1
        for name, label, _ in PRESETS:
            text = "Reset All" if several and name == "RESET" else label
            operator = grid.operator(operators.SPECTRAL_TV_OT_filter.bl_idname, text=text)
            operator.preset = name
            operator.first, operator.last = settings.chosen(name)
            operator.amount = settings.amount
        if several:
            text = f"Reset {record_of(context.active_object).name} Alone"
            reset = layout.operator(operators.SPECTRAL_TV_OT_filter.bl_idname, text=text)
            reset.preset, reset.every = "RESET", False
        row = layout.row(align=True)
        take = row.operator(SPECTRAL_TV_OT_take_bands.bl_idname, icon="IMPORT")
        take.first, take.last = settings.first, settings.last
        take_all(row, text="", icon="ADD")


class SPECTRAL_TV_PT_curve(BandsPanel, bpy.types.Panel):
    """A filter of any shape"""

    bl_label = "Filter Curve"

    def rows(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        obj, node = context.active_object, filter_curve.find()
        if node is None:
            layout.operator(operators.SPECTRAL_TV_OT_add_curve.bl_idname, icon="FCURVE")
            return
        curve_watch.look(node)
        layout.template_curve_mapping(node, "mapping")
        row = layout.row()
        row.label(text="Finest")
        right = row.row()
        right.alignment = "RIGHT"
        right.label(text="Largest")
        remarks.draw(layout, context, obj.data, "curve", curve_watch.state(obj))
        layout.operator(operators.SPECTRAL_TV_OT_apply_curve.bl_idname)


class SPECTRAL_TV_PT_modifiers(BandsPanel, bpy.types.Panel):
    """Modifiers, which Blender does not apply to a mesh with shape keys"""

    bl_label = "Apply Modifiers"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return super().poll(context) and len(appliable(context.active_object)) > 0

    def rows(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        obj = context.active_object
        reason = apply_refusal(obj)
        if reason is not None:
            say(layout, context, reason, "INFO")
        column = layout.column(align=True)
        for modifier in appliable(obj):
            row = column.row(align=True)
            row.enabled = modifier.show_viewport
            operator = row.operator(
                SPECTRAL_TV_OT_apply_modifier.bl_idname, text=modifier.name, icon="CHECKMARK"
            )
            operator.modifier = modifier.name
