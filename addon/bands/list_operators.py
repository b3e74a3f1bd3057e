"""Operators of the list of decompositions: one is made active, or removed."""

from typing import TYPE_CHECKING

import bpy
from bpy.props import StringProperty
from spectral_tv.notes import listed, note
from spectral_tv.refusal import Refusal

from ..job.operator import ChangeOperator
from ..scene import masks
from ..scene.decomposition import SpectralTVRecord
from ..scene.fingerprints import Likeness
from ..scene.objects import refusal
from ..scene.records import (
    activate,
    adopt,
    chosen_record,
    keeping_of,
    recognise_bands,
    record_of,
    remove_record,
)
from . import heights

if TYPE_CHECKING:
    from ..scene.keeping import Band


class SPECTRAL_TV_OT_switch_decomposition(ChangeOperator, bpy.types.Operator):
    """Show and set the bands of this decomposition"""

    bl_idname = "spectral_tv.switch_decomposition"
    bl_label = "Switch to Decomposition"

    name: StringProperty(name="Name", description="Of the decomposition")

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return _refusal(context.active_object, override=True)

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> None:
        if obj.override_library is None and obj.data.override_library is None:
            adopt(obj.data)
        if not activate(obj.data, self.name):
            raise Refusal(f"it has no decomposition {self.name!r}")


class SPECTRAL_TV_OT_remove_decomposition(ChangeOperator, bpy.types.Operator):
    """Remove a decomposition with the shape keys or attributes that are its bands, and with what
    animates these. Others stay"""

    bl_idname = "spectral_tv.remove_decomposition"
    bl_label = "Remove Decomposition"

    name: StringProperty(
        name="Name",
        description="Of the decomposition; the active one if left empty",
        options={"SKIP_SAVE"},
    )

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return _refusal(context.active_object, override=False)

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> str:
        adopt(obj.data)
        record = chosen_record(obj, self.name)
        name, keeping = record.name, keeping_of(record)
        reason = keeping.refusal(obj)
        if reason is not None:
            raise Refusal(reason)
        likes = recognise_bands(obj, record)
        there = keeping.all(obj)
        bands = [there[key] for key, _ in likes if key]
        names = [band.name for band in bands]
        _tell(obj, record, bands, [key for key, like in likes if like == Likeness.CHANGED])
        pairs = zip(record.bands, likes, strict=True)
        left = [band.key for band, (key, _) in pairs if not key and band.key in there]
        if left:
            note(f"these are no longer what its bands were, and stay: {listed(left)}")
        left = heights.names_of(obj, name)
        if left:
            note(f"the heights of its bands stay as attributes: {listed(left)}")
        keeping.remove(obj, bands)
        remove_record(obj, name)
        masks.release(obj)
        gone = f"its {keeping.label} {listed(names)}" if names else f"no {keeping.label_of_one}"
        return f"removed the decomposition {name!r} and {gone}"


def _refusal(obj: bpy.types.Object | None, override: bool) -> str | None:
    if record_of(obj) is None:
        return "The active object has no bands; decompose it first"
    return refusal(obj, override=override)


def _tell(
    obj: bpy.types.Object, record: SpectralTVRecord, bands: "list[Band]", sculpted: list[str]
) -> None:
    """Note what else goes along with bands, and what is left without them."""
    keeping = keeping_of(record)
    acting = [band.name for band in bands if band.value != 0 and not band.mute]
    if acting:
        note(f"the shape changes, as these bands were not at 0: {listed(acting)}")
    animated = [band.name for band in bands if keeping.animation_of(band, "value")]
    if animated:
        note(f"the animation of these bands went too: {listed(animated)}")
    if sculpted:
        note(f"what was sculpted went too: {listed(sculpted)}")
    left = keeping.readers(obj, bands)
    if left:
        note(f"drivers of {listed(left)} read these bands, and find them no more")
