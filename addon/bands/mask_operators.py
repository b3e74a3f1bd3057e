"""Operators that make and change the masks of bands, each the work of a moment."""

from typing import Any

import bpy
from bpy.props import EnumProperty, IntProperty, StringProperty
from spectral_tv.later import np
from spectral_tv.notes import listed, note
from spectral_tv.refusal import Refusal

from ..scene import keeping, masks, multires
from ..scene.arrays import numbers
from ..scene.modes import out_of_edit_mode
from ..scene.objects import refusal
from ..scene.records import band_of, bands_of, record_of, topology_changed
from ..scene.weights import group_named, weights_of
from .set_bands import BandsOperator, bands_refusal

SOURCES = (
    ("SELECTION", "Selection", "The selected vertices"),
    ("GROUP", "Vertex Group", "The weights of a vertex group, such as a segment"),
    ("SCULPT_MASK", "Sculpt Mask", "All but what is masked in Sculpt Mode, and cannot be sculpted"),
)
COMBINE = (
    ("REPLACE", "Replace", "It becomes the mask"),
    ("ADD", "Add", "The band acts there too"),
    ("SUBTRACT", "Subtract", "The band does not act there"),
)


def mask_refusal(obj: bpy.types.Object | None) -> str | None:
    """Why no band can be masked in Edit Mode or another one, in a sentence; None if one can."""
    if obj is None or obj.mode != "EDIT" or record_of(obj) is None:
        return bands_refusal(obj, override=False)
    return refusal(obj, edit_mode=True)


def masked_band(obj: bpy.types.Object, number: int) -> "keeping.Band":
    """A band that a mask fits, as of records.band_of; raises Refusal if the mesh changed since."""
    if topology_changed(obj):
        raise Refusal("vertices or faces changed since; decompose the mesh again")
    return band_of(obj, number)


def band_number() -> Any:
    """The property that says whose mask."""
    return IntProperty(name="Band", description="Whose mask; 1 is the finest", default=1, min=1)


class MaskOperator(BandsOperator):
    """What all of them share."""

    changes_keys = True

    band: band_number()


class SPECTRAL_TV_OT_invert_mask(MaskOperator, bpy.types.Operator):
    """Have the band act where it does not, and not where it does"""

    bl_idname = "spectral_tv.invert_mask"
    bl_label = "Invert Mask"

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> str:
        band = masked_band(obj, self.band)
        group = masks.give(obj, band, 1 - masks.weights(obj, band))
        return f"the mask {group.name!r} is inverted"


class SPECTRAL_TV_OT_copy_mask(MaskOperator, bpy.types.Operator):
    """Give other bands masks of their own with the weights of this one"""

    bl_idname = "spectral_tv.copy_mask"
    bl_label = "Copy Mask"

    to: IntProperty(
        name="To",
        description="The band that gets it; 0 is all others of the active decomposition",
        default=0,
        min=0,
    )

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> str:
        band = masked_band(obj, self.band)
        found = masks.weights(obj, band)
        if self.to:
            others = [masked_band(obj, self.to)]
        else:
            others = [each for each in bands_of(obj) if each is not None]
        others = [each for each in others if each != band]
        if not others:
            raise Refusal("there is no other band")
        for each in others:
            masks.give(obj, each, found)
        return f"{listed(each.name for each in others)} have the mask of {band.name}"


class SPECTRAL_TV_OT_choose_mask(MaskOperator, bpy.types.Operator):
    """Have a vertex group be the mask of the band, as it is"""

    bl_idname = "spectral_tv.choose_mask"
    bl_label = "Choose Mask"

    group: StringProperty(name="Vertex Group", description="The mask")

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> str:
        band, group = masked_band(obj, self.band), group_named(obj, self.group)
        former = band.vertex_group
        masks.choose(obj, band, group)
        stays = former in obj.vertex_groups and former != group.name
        told = f"; the vertex group {former!r} stays" if stays else ""
        return f"{band.name!r} is masked by {group.name!r}{told}"

    def draw(self, context: bpy.types.Context) -> None:
        """Lay out Adjust Last Operation."""
        self.layout.use_property_split = True
        self.layout.prop(self, "band")
        self.layout.prop_search(self, "group", context.active_object, "vertex_groups")


class SPECTRAL_TV_OT_fill_mask(MaskOperator, bpy.types.Operator):
    """Make the mask of the band of the selection, of a segment or another vertex group, or of what
    Sculpt Mode does not mask"""

    bl_idname = "spectral_tv.fill_mask"
    bl_label = "Fill Mask"

    source: EnumProperty(name="From", description="Of what", items=SOURCES)
    group: StringProperty(name="Vertex Group", description="Of which one, if it is of one")
    combine: EnumProperty(name="Combine", description="With the mask there is", items=COMBINE)

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return mask_refusal(context.active_object)

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> str:
        with out_of_edit_mode(obj):
            band = masked_band(obj, self.band)
            found = self._combined(obj, band, self._read(obj))
            group = masks.give(obj, band, found)
            count = int(np.count_nonzero(found))
            if not count:
                note(f"{band.name!r} acts nowhere now")
            return f"{band.name!r} acts on {count} of {len(found)} vertices, by {group.name!r}"

    def draw(self, context: bpy.types.Context) -> None:
        """Lay out Adjust Last Operation."""
        self.layout.use_property_split = True
        for name in ("band", "source"):
            self.layout.prop(self, name)
        if self.source == "GROUP":
            self.layout.prop_search(self, "group", context.active_object, "vertex_groups")
        self.layout.prop(self, "combine")

    def _read(self, obj: bpy.types.Object) -> "np.ndarray":
        """What it is filled with, (V,)."""
        if self.source == "GROUP":
            return weights_of(obj, group_named(obj, self.group))
        if self.source == "SELECTION":
            found = numbers(obj.data.vertices, "select", dtype=bool)
            if not found.any():
                raise Refusal("no vertex is selected; select some in Edit Mode")
            return found.astype(np.float64)
        found = masks.sculpt_mask(obj.data)
        if multires.is_masked(obj) and (found is None or not found.any()):
            raise Refusal("what is masked is in its levels, of which Blender gives out no masks")
        if found is None:
            raise Refusal("nothing is masked in Sculpt Mode")
        return 1 - found

    def _combined(
        self, obj: bpy.types.Object, band: "keeping.Band", found: "np.ndarray"
    ) -> "np.ndarray":
        if self.combine == "REPLACE":
            return found
        if masks.mask_group(obj, band) is None:  # so far it acts everywhere
            if self.combine == "ADD":
                raise Refusal(f"{band.name!r} has no mask, so it acts everywhere")
            return 1 - found
        before = masks.weights(obj, band)
        return np.maximum(before, found) if self.combine == "ADD" else np.minimum(before, 1 - found)


class SPECTRAL_TV_OT_own_mask(MaskOperator, bpy.types.Operator):
    """Give the band a copy of its mask that nothing else uses"""

    bl_idname = "spectral_tv.own_mask"
    bl_label = "Make Own Mask"

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> str:
        band = masked_band(obj, self.band)
        group = masks.give(obj, band, masks.weights(obj, band))
        return f"the mask of {band.name!r} is {group.name!r}"


class SPECTRAL_TV_OT_remove_mask(MaskOperator, bpy.types.Operator):
    """Have the band act everywhere. The vertex group is removed if it was made as this mask and
    nothing else uses it; any other one stays"""

    bl_idname = "spectral_tv.remove_mask"
    bl_label = "Remove Mask"

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> str:
        band = masked_band(obj, self.band)
        return f"{band.name!r} acts everywhere; {masks.remove(obj, band)}"
