"""Operators that set the bands: presets, the curve, solo, keyframes, baking, other objects."""

import bpy
from bpy.props import EnumProperty, FloatProperty, IntProperty

from ..decomposition.bands import cut_again, has_flow, set_values
from ..filters import filter_curve
from ..filters.gains import PRESETS, curve_values, preset_values
from ..scene.objects import Refusal, refusal
from ..scene.records import band_keys, record_of, topology_changed


def bands_refusal(obj: bpy.types.Object | None, override: bool = True) -> str | None:
    """Why there are no bands to set, in a sentence for the user; None if there are.

    A library override is a reason unless ``override`` allows it.
    """
    if record_of(obj) is None:
        return "The active object has no bands; decompose it first"
    reason = refusal(obj, override=override)
    if reason is None and topology_changed(obj):
        reason = "Vertices or faces changed since; decompose the mesh again"
    return reason


class BandsOperator:
    """What all of them share."""

    bl_options = {"REGISTER", "UNDO"}

    # Whether shape keys come or go: on a library override that would not be saved, values are.
    changes_keys = False

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        reason = bands_refusal(context.active_object, override=not cls.changes_keys)
        if reason is not None:
            cls.poll_message_set(reason)
        return reason is None


class SPECTRAL_TV_OT_filter(BandsOperator, bpy.types.Operator):
    """Set the bands to a common filter"""

    bl_idname = "spectral_tv.filter"
    bl_label = "Filter"

    preset: EnumProperty(name="Filter", items=PRESETS, default="LOW_PASS")
    first: IntProperty(name="First Band", description="1 is the finest", default=3, min=1)
    last: IntProperty(name="Last Band", description="1 is the finest", default=3, min=1)
    amount: FloatProperty(
        name="Amount",
        description="How much is added to the chosen bands: 1 doubles them",
        default=1,
        soft_min=-1,
        soft_max=4,
    )

    @classmethod
    def description(cls, _context, properties) -> str:
        return next(text for name, _, text in PRESETS if name == properties.preset)

    def execute(self, context: bpy.types.Context) -> set[str]:
        obj = context.active_object
        count = len(record_of(obj).bands)
        set_values(obj, preset_values(self.preset, count, self.first, self.last, self.amount))
        return {"FINISHED"}


class SPECTRAL_TV_OT_add_curve(BandsOperator, bpy.types.Operator):
    """Draw the filter as a curve: left is the finest band, right the largest, 1 keeps a band"""

    bl_idname = "spectral_tv.add_curve"
    bl_label = "Draw a Filter Curve"

    def execute(self, _context: bpy.types.Context) -> set[str]:
        filter_curve.ensure()
        return {"FINISHED"}


class SPECTRAL_TV_OT_apply_curve(BandsOperator, bpy.types.Operator):
    """Set every band to the height of the curve above it"""

    bl_idname = "spectral_tv.apply_curve"
    bl_label = "Apply Curve"

    def execute(self, context: bpy.types.Context) -> set[str]:
        node = filter_curve.ensure()
        count = len(record_of(context.active_object).bands)
        values = curve_values(lambda position: filter_curve.evaluate(node, position), count)
        set_values(context.active_object, values)
        return {"FINISHED"}


class SPECTRAL_TV_OT_solo(BandsOperator, bpy.types.Operator):
    """Mute all other bands; again to hear them all"""

    bl_idname = "spectral_tv.solo"
    bl_label = "Solo"

    band: IntProperty(name="Band", description="1 is the finest", default=1, min=1)

    def execute(self, context: bpy.types.Context) -> set[str]:
        keys = [key for key in band_keys(context.active_object) if key is not None]
        chosen = band_keys(context.active_object)[self.band - 1 : self.band]
        is_solo = chosen and all(key.mute == (key not in chosen) for key in keys)
        for key in keys:
            key.mute = not is_solo and key not in chosen
        return {"FINISHED"}


class SPECTRAL_TV_OT_keyframe(BandsOperator, bpy.types.Operator):
    """Insert a keyframe for the value of every band on the current frame"""

    bl_idname = "spectral_tv.keyframe"
    bl_label = "Keyframe All Bands"

    def execute(self, context: bpy.types.Context) -> set[str]:
        for key in band_keys(context.active_object):
            if key is not None:
                key.keyframe_insert("value", frame=context.scene.frame_current)
        return {"FINISHED"}


class SPECTRAL_TV_OT_bake(BandsOperator, bpy.types.Operator):
    """Add the present mix of all shape keys as one new shape key, at value 0"""

    bl_idname = "spectral_tv.bake"
    bl_label = "Bake Mix"
    changes_keys = True

    def execute(self, context: bpy.types.Context) -> set[str]:
        obj = context.active_object
        active = obj.active_shape_key_index
        key = obj.shape_key_add(name="Filtered", from_mix=True)
        key.value = 0
        obj.active_shape_key_index = active
        self.report({"INFO"}, f"Added the shape key {key.name}")
        return {"FINISHED"}


class SPECTRAL_TV_OT_copy_filter(BandsOperator, bpy.types.Operator):
    """Give the selected objects' bands the values of the active object's"""

    bl_idname = "spectral_tv.copy_filter"
    bl_label = "Copy Filter to Selected"

    def execute(self, context: bpy.types.Context) -> set[str]:
        source = context.active_object
        values = [key.value if key is not None else 0.0 for key in band_keys(source)]
        skipped = []
        others = [obj for obj in context.selected_objects if obj != source]
        for obj in others:
            record = record_of(obj)
            if (
                bands_refusal(obj) is not None
                or len(record.bands) != len(values)
                or record.method != record_of(source).method
            ):
                skipped.append(obj.name)
            else:
                set_values(obj, values)
        if skipped:
            names = ", ".join(skipped)
            message = f"Decompose these alike first, they were left as they are: {names}"
            self.report({"WARNING"}, message)
        if len(skipped) == len(others):
            if not others:
                self.report({"WARNING"}, "Select the other objects too")
            return {"CANCELLED"}
        return {"FINISHED"}


class SPECTRAL_TV_OT_cut(BandsOperator, bpy.types.Operator):
    """Cut the same flow into another number of bands, without flowing again"""

    bl_idname = "spectral_tv.cut"
    bl_label = "Cut Again"
    changes_keys = True

    bands: IntProperty(name="Bands", default=5, min=1, max=32)

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not super().poll(context):
            return False
        if not has_flow(record_of(context.active_object).identifier):
            cls.poll_message_set("The flow is no longer in memory; decompose the mesh again")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        obj = context.active_object
        try:
            cut_again(obj, self.bands)
        except (Refusal, ValueError) as error:
            self.report({"ERROR"}, f"{obj.name}: {error}")
            return {"CANCELLED"}
        return {"FINISHED"}


CLASSES = (
    SPECTRAL_TV_OT_filter,
    SPECTRAL_TV_OT_add_curve,
    SPECTRAL_TV_OT_apply_curve,
    SPECTRAL_TV_OT_solo,
    SPECTRAL_TV_OT_keyframe,
    SPECTRAL_TV_OT_bake,
    SPECTRAL_TV_OT_copy_filter,
    SPECTRAL_TV_OT_cut,
)
