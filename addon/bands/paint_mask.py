"""The operator of the brush beside a band: into Weight Paint with its mask, and out again."""

import bpy
from bpy.props import FloatProperty, StringProperty
from spectral_tv.later import np
from spectral_tv.notes import note

from ..scene import keeping, masks
from ..scene.group_users import told
from ..scene.modes import set_mode
from .mask_operators import MaskOperator, mask_refusal, masked_band

PAINTING = "WEIGHT_PAINT"


class SpectralTVPainting(bpy.types.PropertyGroup):
    """Where the brush beside a band found an object."""

    owner = bpy.types.Object, "spectral_tv_painting"

    mode: StringProperty(name="Mode", description="Of the object before its mask was painted")
    group: StringProperty(name="Group", description="The vertex group that was active then")


class SPECTRAL_TV_OT_paint_mask(MaskOperator, bpy.types.Operator):
    """Paint where the band acts, in Weight Paint; again to go back. Without a mask one is made, by
    which the band acts everywhere: paint weight 0, or hold Ctrl, where it shall not"""

    bl_idname = "spectral_tv.paint_mask"
    bl_label = "Paint Mask"

    weight: FloatProperty(
        name="Weight",
        description="Of every vertex in a new mask. With 1 the band acts everywhere at first, with "
        "0 nowhere",
        default=1,
        min=0,
        max=1,
        subtype="FACTOR",
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return mask_refusal(context.active_object)

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> str | None:
        painting, former = obj.spectral_tv_painting, obj.mode
        if former == "EDIT":
            set_mode(obj, "OBJECT")
        try:
            band = masked_band(obj, self.band)
            if is_painted(obj, band):
                set_mode(obj, painting.mode or "OBJECT")
                if painting.group in obj.vertex_groups:
                    obj.vertex_groups.active = obj.vertex_groups[painting.group]
                for name in ("mode", "group"):
                    painting.property_unset(name)
                return None
            active = obj.vertex_groups.active
            former_group = "" if active is None else active.name
            done = self._ready(obj, band)
            set_mode(obj, PAINTING)
        except BaseException:
            set_mode(obj, former)
            raise
        if former != PAINTING:
            painting.mode, painting.group = former, former_group
        return done

    def _ready(self, obj: bpy.types.Object, band: "keeping.Band") -> str:
        """Have its mask be the active vertex group, one that is made if there is none."""
        group, done = masks.mask_group(obj, band), "is the mask that is painted"
        if group is None:
            group = masks.give(obj, band, np.full(len(obj.data.vertices), self.weight))
            done = "is the new mask; paint weight 0, or hold Ctrl, where the band shall not act"
        obj.vertex_groups.active_index = group.index
        others = told(obj, group.name, [band.name])
        if others:
            note(f"{others} use {group.name!r} too, and change as it is painted")
        if group.lock_weight:
            note(f"the vertex group {group.name!r} is locked, and cannot be painted")
        if band.mute or band.value == 0:
            how = "is muted" if band.mute else "is at 0"
            note(f"{band.name!r} {how}, so that its mask is not seen in the shape")
        return f"{group.name!r} {done}"


def is_painted(obj: bpy.types.Object, band: "keeping.Band") -> bool:
    """Whether the mask of a band is what is painted now."""
    group = masks.mask_group(obj, band)
    return obj.mode == PAINTING and group is not None and obj.vertex_groups.active == group
