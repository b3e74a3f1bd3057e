"""The brush and the menu beside each band."""

from typing import Any

import bpy

from ..scene import keeping, masks
from ..scene.decomposition import SpectralTVRecord
from ..scene.records import bands_shown, record_of
from ..scene.results import PARTS, SEGMENTS, groups_shown
from .blur_mask import SPECTRAL_TV_OT_blur_mask
from .mask_operators import (
    SPECTRAL_TV_OT_choose_mask,
    SPECTRAL_TV_OT_copy_mask,
    SPECTRAL_TV_OT_fill_mask,
    SPECTRAL_TV_OT_invert_mask,
    SPECTRAL_TV_OT_own_mask,
    SPECTRAL_TV_OT_remove_mask,
)
from .paint_mask import SPECTRAL_TV_OT_paint_mask, is_painted

# What menus know their band by.
POINTER = "spectral_tv_band"


def draw(
    row: bpy.types.UILayout, obj: bpy.types.Object, record: SpectralTVRecord, number: int
) -> None:
    """Draw the brush and the menu of a band of a decomposition."""
    band = bands_shown(obj, record)[number - 1]
    brush = row.operator(
        SPECTRAL_TV_OT_paint_mask.bl_idname,
        text="",
        icon=_icon(obj, band),
        depress=is_painted(obj, band),
    )
    brush.band = number
    part = row.row(align=True)
    part.context_pointer_set(POINTER, record.bands[number - 1])
    part.menu(SPECTRAL_TV_MT_mask.__name__, text="", icon="DOWNARROW_HLT")


def _icon(obj: bpy.types.Object, band: "keeping.Band") -> str:
    if not band.vertex_group:
        return "BRUSH_DATA"
    return "ERROR" if masks.mask_group(obj, band) is None else "MOD_MASK"


def _item(
    layout: bpy.types.UILayout,
    operator: type[bpy.types.Operator],
    number: int,
    text: str = "",
    icon: str = "NONE",
    **more: Any,
) -> None:
    """Draw an operator of the band of a number."""
    button = layout.operator(operator.bl_idname, text=text or operator.bl_label, icon=icon)
    for name, value in {"band": number, **more}.items():
        setattr(button, name, value)


class MaskMenu:
    """A menu of one band."""

    def draw(self, context: bpy.types.Context) -> None:
        band, obj = getattr(context, POINTER, None), context.active_object
        record = record_of(obj) if band is not None else None
        found = [] if record is None else [*record.bands]
        if band in found and bands_shown(obj)[found.index(band)] is not None:
            self.layout.context_pointer_set(POINTER, band)
            self.items(self.layout, obj, found.index(band) + 1)

    @staticmethod
    def items(layout: bpy.types.UILayout, obj: bpy.types.Object, number: int) -> None:
        """Draw what there is to choose for a band."""
        raise NotImplementedError


class SPECTRAL_TV_MT_mask(MaskMenu, bpy.types.Menu):
    """What can be done with the mask of the band"""

    bl_label = "Mask"

    @staticmethod
    def items(layout: bpy.types.UILayout, obj: bpy.types.Object, number: int) -> None:
        band = bands_shown(obj)[number - 1]
        layout.label(text=band.vertex_group or "No mask: it acts everywhere")
        layout.separator()
        fill = SPECTRAL_TV_OT_fill_mask
        _item(layout, fill, number, "From Selection", "RESTRICT_SELECT_OFF", source="SELECTION")
        _item(layout, fill, number, "From Sculpt Mask", "SCULPTMODE_HLT", source="SCULPT_MASK")
        layout.menu(SPECTRAL_TV_MT_mask_of_segment.__name__, icon="COLOR")
        layout.menu(SPECTRAL_TV_MT_mask_group.__name__, icon="GROUP_VERTEX")
        layout.separator()
        there = layout.column()
        there.enabled = masks.mask_group(obj, band) is not None
        _item(there, SPECTRAL_TV_OT_invert_mask, number, icon="ARROW_LEFTRIGHT")
        _item(there, SPECTRAL_TV_OT_blur_mask, number, icon="MOD_SMOOTH")
        there.menu(SPECTRAL_TV_MT_mask_copy.__name__, icon="COPYDOWN")
        _item(there, SPECTRAL_TV_OT_own_mask, number, icon="DUPLICATE")
        layout.separator()
        last = layout.column()
        last.enabled = bool(band.vertex_group)
        _item(last, SPECTRAL_TV_OT_remove_mask, number, icon="X")


class SPECTRAL_TV_MT_mask_of_segment(MaskMenu, bpy.types.Menu):
    """Make the mask of a part that Segment Selected or Split into Connected Parts has found"""

    bl_label = "From Segment"

    @staticmethod
    def items(layout: bpy.types.UILayout, obj: bpy.types.Object, number: int) -> None:
        names = [*groups_shown(obj, SEGMENTS), *groups_shown(obj, PARTS)]
        for name in sorted(names, key=list(obj.vertex_groups.keys()).index):
            _item(layout, SPECTRAL_TV_OT_fill_mask, number, name, source="GROUP", group=name)
        if not names:
            layout.label(text="Press Segment Selected first")


class SPECTRAL_TV_MT_mask_group(MaskMenu, bpy.types.Menu):
    """Have a vertex group be the mask as it is"""

    bl_label = "Choose Vertex Group"

    @staticmethod
    def items(layout: bpy.types.UILayout, obj: bpy.types.Object, number: int) -> None:
        for name, _ in obj.vertex_groups.items():
            _item(layout, SPECTRAL_TV_OT_choose_mask, number, name, group=name)
        if not obj.vertex_groups:
            layout.label(text="There are no vertex groups")


class SPECTRAL_TV_MT_mask_copy(MaskMenu, bpy.types.Menu):
    """Give other bands masks with the same weights"""

    bl_label = "Copy To"

    @staticmethod
    def items(layout: bpy.types.UILayout, obj: bpy.types.Object, number: int) -> None:
        _item(layout, SPECTRAL_TV_OT_copy_mask, number, "All Other Bands", to=0)
        layout.separator()
        for to, band in enumerate(bands_shown(obj), start=1):
            if band is not None and to != number:
                _item(layout, SPECTRAL_TV_OT_copy_mask, number, band.name, to=to)
