"""Operators that set the bands: presets, the curve, solo, keyframes, baking, other objects."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty
from spectral_tv.bands.filtering import FilterSettings
from spectral_tv.bands.gains import PRESETS, curve_values, idle_reason, preset_values
from spectral_tv.bands.settings import Settings
from spectral_tv.later import np
from spectral_tv.notes import about, note
from spectral_tv.options.declaring import OWN, options_of
from spectral_tv.refusal import Refusal

from ..job.operator import ChangeOperator
from ..options.properties import property_of
from ..scene import mix, shape_keys
from ..scene.attribute_band import attribute_bands
from ..scene.coordinates import basis_coordinates
from ..scene.decomposition import SpectralTVRecord
from ..scene.objects import refusal
from ..scene.records import (
    bands_of,
    counts_differ,
    keeping_of,
    record_of,
    records_of,
    renew_bands,
    topology_changed,
)
from . import adding, filter_curve, original, solo
from .bands import flows, set_values

LIMBS = options_of(Settings)["keep_limbs"]
# Bands whose ends differ by less, relative to them, are of the same sizes.
SAME_SCALES = 0.01


def bands_refusal(
    obj: bpy.types.Object | None,
    override: bool = True,
    original_too: bool = False,
    values_alone: bool = False,
) -> str | None:
    """Why there are no bands to set, in a sentence for the user; None if there are.

    A library override is a reason unless ``override`` allows it, and so is the original that is
    shown instead of the look unless ``original_too`` does. Where ``values_alone`` are set, the mesh
    may be linked if the object has its own.
    """
    record = record_of(obj)
    if record is None:
        return "The active object has no bands; decompose it first"
    linked_mesh = values_alone and keeping_of(record).has_own_values
    reason = refusal(obj, override=override, linked_mesh=linked_mesh)
    if reason is None and topology_changed(obj):
        reason = "Vertices or faces changed since; decompose the mesh again"
    if reason is None and not original_too and original.is_shown(obj):
        reason = original.REASON
    return reason


def cut_refusal(obj: bpy.types.Object | None) -> str | None:
    """Why bands cannot be cut anew, in a sentence for the user; None if they can."""
    reason = bands_refusal(obj, override=False)
    if reason is None:
        reason = keeping_of(record_of(obj)).refusal(obj)
    if reason is None and counts_differ(obj, record_of(obj)):
        reason = "Vertices or faces changed since; decompose the mesh again"
    if reason is None and record_of(obj).identifier not in flows:
        reason = "The flow is no longer in memory; decompose the mesh again"
    return reason


class BandsOperator(ChangeOperator):
    """What all of them share."""

    # Whether shape keys come or go: on a library override that would not be saved, values are.
    changes_keys = False
    # Whether it sets values and nothing beside them, so that a linked mesh may have the bands.
    sets_values_alone = False

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        obj, values_alone = context.active_object, cls.sets_values_alone
        return bands_refusal(obj, override=not cls.changes_keys, values_alone=values_alone)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Do it to what the bands are today."""
        renew_bands(context.active_object)
        return super().execute(context)


class SPECTRAL_TV_OT_filter(BandsOperator, bpy.types.Operator):
    """Set the bands to a common filter"""

    bl_idname = "spectral_tv.filter"
    bl_label = "Filter"
    sets_values_alone = True

    preset: EnumProperty(name="Filter", items=PRESETS, default="LOW_PASS")
    first: property_of(FilterSettings, "first")
    last: property_of(FilterSettings, "last")
    amount: property_of(FilterSettings, "amount")
    every: BoolProperty(
        name="Every Decomposition",
        description="Reset sets the bands of all decompositions back, not of the active one alone",
        default=True,
        options={"SKIP_SAVE"},
    )

    @classmethod
    def description(cls, _context, properties) -> str:
        if properties.preset == "RESET" and not properties.every:
            return "Set every band of the active decomposition back to its original strength"
        return next(text for name, _, text in PRESETS if name == properties.preset)

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> None:
        choice = len(record_of(obj).bands), self.first, self.last, self.amount
        reason = idle_reason(self.preset, *choice)
        if reason is not None:
            note(reason)
        if self.preset != "RESET" or not self.every:
            set_values(obj, preset_values(self.preset, *choice))
            return
        for record in records_of(obj):
            set_values(obj, [0.0] * len(record.bands), record)


class SPECTRAL_TV_OT_add_curve(BandsOperator, bpy.types.Operator):
    """Draw the filter as a curve: left is the finest band, right the largest, 1 keeps a band"""

    bl_idname = "spectral_tv.add_curve"
    bl_label = "Draw a Filter Curve"
    sets_values_alone = True

    def change(self, _context: bpy.types.Context, _obj: bpy.types.Object) -> None:
        filter_curve.ensure()


class SPECTRAL_TV_OT_apply_curve(BandsOperator, bpy.types.Operator):
    """Set every band to the height of the curve above it"""

    bl_idname = "spectral_tv.apply_curve"
    bl_label = "Apply Curve"
    sets_values_alone = True

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> None:
        apply_curve(obj)


def apply_curve(obj: bpy.types.Object) -> None:
    """Set every band of the active decomposition to the height of the curve above it."""
    node = filter_curve.ensure()
    count = len(record_of(obj).bands)
    set_values(obj, curve_values(lambda position: filter_curve.evaluate(node, position), count))


class SPECTRAL_TV_OT_solo(BandsOperator, bpy.types.Operator):
    """Mute all other bands; again to have them as they were"""

    bl_idname = "spectral_tv.solo"
    bl_label = "Solo"

    band: IntProperty(name="Band", description="1 is the finest", default=1, min=1)

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> None:
        solo.toggle_solo(obj, self.band)


class SPECTRAL_TV_OT_keyframe(BandsOperator, bpy.types.Operator):
    """Insert a keyframe for the value of every band on the current frame"""

    bl_idname = "spectral_tv.keyframe"
    bl_label = "Keyframe All Bands"
    sets_values_alone = True

    def change(self, context: bpy.types.Context, obj: bpy.types.Object) -> None:
        keys = [key for key in bands_of(obj) if key is not None]
        frame, keyframe = context.scene.frame_current, keeping_of(record_of(obj)).keyframe
        failed = [key.name for key in keys if not keyframe(key, "value", frame)]
        if failed:
            told = (
                f"Blender inserts no keyframes for {', '.join(failed)}: their animation is linked "
            )
            told += "from another file, or locked"
            if len(failed) == len(keys):
                raise Refusal(told)
            note(told)


class SPECTRAL_TV_OT_bake(BandsOperator, bpy.types.Operator):
    """Add the present mix of all shape keys and bands as one new shape key, at value 0"""

    bl_idname = "spectral_tv.bake"
    bl_label = "Bake Mix"
    changes_keys = True

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> str:
        active = obj.active_shape_key_index
        if attribute_bands(obj):  # which are no part of what Blender calls the mix
            moved = mix.shown(obj) - basis_coordinates(obj.data)
            (key,) = shape_keys.add_displacements(obj, ["Filtered"], [moved])
        else:
            key = obj.shape_key_add(name="Filtered", from_mix=True)
        key.value = 0
        obj.active_shape_key_index = active
        return f"added the shape key {key.name!r}"


class SPECTRAL_TV_OT_copy_filter(BandsOperator, bpy.types.Operator):
    """Give bands of the selected objects the values of the active object's active decomposition"""

    bl_idname = "spectral_tv.copy_filter"
    bl_label = "Copy Filter to Selected"
    sets_values_alone = True

    def change(self, context: bpy.types.Context, source: bpy.types.Object) -> str:
        others = [obj for obj in context.selected_objects if obj != source]
        if not others:
            raise Refusal("select the other objects too")
        values = [key.value if key is not None else 0.0 for key in bands_of(source)]
        records = {obj: _alike(obj, source) for obj in others}
        alike = [obj for obj in others if records[obj] is not None]
        skipped = ", ".join(obj.name for obj in others if obj not in alike)
        if skipped:
            told = (
                f"decompose these by the same settings first, they were left as they are: {skipped}"
            )
            if not alike:
                raise Refusal(told)
            note(told)
        for obj in alike:
            with about(obj.name):
                set_values(obj, values, records[obj])
                if records[obj] != record_of(obj):
                    note(f"they are of {records[obj].name!r}, which is not the active one")
        return f"its filter is that of {', '.join(obj.name for obj in alike)} too"


def _alike(obj: bpy.types.Object, source: bpy.types.Object) -> SpectralTVRecord | None:
    """The decomposition of an object that is like the active one of another: that one which is
    active, if it is. None if none is."""
    if bands_refusal(obj, values_alone=True) is not None:
        return None
    active, other = record_of(obj), record_of(source)
    records = [active, *(each for each in records_of(obj) if each != active)]
    return next((each for each in records if _is_alike(each, other)), None)


def _is_alike(record: SpectralTVRecord, other: SpectralTVRecord) -> bool:
    """Whether bands of two decompositions, from the finest, are of the same relative sizes."""
    if len(record.bands) != len(other.bands) or record.method != other.method:
        return False
    edges, others = (
        np.array([band.end for band in each.bands]) / each.area for each in (record, other)
    )
    return np.allclose(edges, others, rtol=SAME_SCALES)


class SPECTRAL_TV_OT_cut(BandsOperator, bpy.types.Operator):
    """Cut the same flow into another number of bands, without flowing again"""

    bl_idname = "spectral_tv.cut"
    bl_label = "Cut Again"
    changes_keys = True

    bands: IntProperty(name="Bands", default=5, min=1, max=32)
    keep_limbs: FloatProperty(
        name=LIMBS.label, description=f"{LIMBS.text}. −1 leaves it as it is", default=OWN, min=OWN,
        max=LIMBS.most, soft_max=LIMBS.soft_most, options={"SKIP_SAVE"}
    )  # fmt: skip

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return cut_refusal(context.active_object)

    def change(self, _context: bpy.types.Context, obj: bpy.types.Object) -> None:
        adding.cut_again(obj, self.bands, None if self.keep_limbs < 0 else self.keep_limbs)
