"""The panel of the bands: the spectrum, a slider per band, filters."""

import bpy

from .. import filter_curve, spectrum
from ..gains import PRESETS
from ..operators import filter as operators
from ..records import band_keys, record_of, topology_changed
from ._sidebar import Sidebar


class BandsPanel(Sidebar):
    """Shown once the active object has bands that still fit its mesh."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        obj = context.active_object
        return record_of(obj) is not None and not topology_changed(obj)


class SPECTRAL_TV_PT_bands(Sidebar, bpy.types.Panel):
    """The bands of the active object"""

    bl_label = "Bands"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return record_of(context.active_object) is not None

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        obj = context.active_object
        record = record_of(obj)
        if topology_changed(obj):
            column = layout.column(align=True)
            column.label(text="The mesh has changed since.", icon="ERROR")
            column.label(text="Decompose it again.", icon="BLANK1")
            return
        row = layout.row(align=True)
        row.alignment = "CENTER"
        for icon in spectrum.icons(record):
            row.template_icon(icon, scale=3.6)
        column = layout.column(align=True)
        for number, key in enumerate(band_keys(obj), start=1):
            row = column.row(align=True)
            if key is None:
                row.label(text=f"Band {number} was deleted", icon="INFO")
                continue
            row.prop(key, "value", text=key.name, slider=True)
            row.prop(key, "mute", text="", icon="HIDE_ON" if key.mute else "HIDE_OFF")
            solo = row.operator(operators.SPECTRAL_TV_OT_solo.bl_idname, text="", icon="SOLO_OFF")
            solo.band = number
        row = layout.row(align=True)
        row.operator(operators.SPECTRAL_TV_OT_keyframe.bl_idname, text="Keyframe", icon="KEY_HLT")
        row.operator(operators.SPECTRAL_TV_OT_bake.bl_idname, icon="SHAPEKEY_DATA")
        layout.operator(operators.SPECTRAL_TV_OT_copy_filter.bl_idname, icon="COPYDOWN")
        row = layout.row(align=True)
        row.prop(context.scene.spectral_tv, "bands")
        cut = row.operator(operators.SPECTRAL_TV_OT_cut.bl_idname)
        cut.bands = context.scene.spectral_tv.bands


class SPECTRAL_TV_PT_filters(BandsPanel, bpy.types.Panel):
    """Common filters"""

    bl_label = "Filters"
    bl_parent_id = "SPECTRAL_TV_PT_bands"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        settings = context.scene.spectral_tv_filter
        row = layout.row(align=True)
        row.prop(settings, "first")
        row.prop(settings, "last")
        layout.prop(settings, "amount")
        grid = layout.grid_flow(columns=2, align=True, even_columns=True)
        for name, label, _ in PRESETS:
            operator = grid.operator(operators.SPECTRAL_TV_OT_filter.bl_idname, text=label)
            operator.preset = name
            operator.first, operator.last = settings.first, settings.last
            operator.amount = settings.amount


class SPECTRAL_TV_PT_curve(BandsPanel, bpy.types.Panel):
    """A filter of any shape"""

    bl_label = "Filter Curve"
    bl_parent_id = "SPECTRAL_TV_PT_bands"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, _context: bpy.types.Context) -> None:
        layout = self.layout
        node = filter_curve.find()
        if node is None:
            layout.operator(operators.SPECTRAL_TV_OT_add_curve.bl_idname, icon="FCURVE")
            return
        layout.template_curve_mapping(node, "mapping")
        row = layout.row()
        row.label(text="Finest")
        right = row.row()
        right.alignment = "RIGHT"
        right.label(text="Largest")
        layout.operator(operators.SPECTRAL_TV_OT_apply_curve.bl_idname)


CLASSES = (SPECTRAL_TV_PT_bands, SPECTRAL_TV_PT_filters, SPECTRAL_TV_PT_curve)
