"""The operator that takes a size of the scales from a feature that is pointed at in the view."""

import math

import bpy
from bpy.props import EnumProperty, FloatProperty
from mathutils import Vector
from spectral_tv.bands.settings import Settings
from spectral_tv.notes import note
from spectral_tv.options.declaring import options_of
from spectral_tv.refusal import Refusal

from ..drawing.pointing import (
    PASSED_ON,
    View,
    on_ray,
    pixel,
    ray,
    shown_mesh,
    tell_next,
    view_under,
)
from ..drawing.ring import Ring
from ..drawing.sizes import size_of
from ..drawing.views import redraw_views
from ..job.operator import ChangeOperator
from ..scene import lengths
from ..scene.objects import refusal
from .properties import PICKER

OPTIONS = {
    name: option
    for name, option in options_of(Settings).items()
    if option.is_size and option.kind == "share"
}
# Sizes that differ by less, relative to them, are the same.
ROUNDING = 1e-5


class SPECTRAL_TV_OT_pick_size(ChangeOperator, bpy.types.Operator):
    """Point at a feature and drag from its middle to its rim: its radius becomes this size. A click
    takes the circle as it is"""

    bl_idname = PICKER
    bl_label = "Pick Size"

    option: EnumProperty(
        name="Option",
        description="What becomes of that size",
        items=[(name, each.label, each.text) for name, each in OPTIONS.items()],
    )
    size: FloatProperty(
        name="Size", description="The radius of the feature", subtype="DISTANCE", min=0,
        precision=4, options={"SKIP_SAVE"}
    )  # fmt: skip

    # The one that is under way.
    running: "SPECTRAL_TV_OT_pick_size | None" = None

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        obj = context.active_object
        reason = refusal(obj)
        if reason is None and size_of(obj) is None:
            reason = "The mesh has no area"
        if reason is None and context.scene.spectral_tv.object_size() is None:
            reason = "The shape is of a new object, whose size is not known"
        if reason is None and not obj.visible_get():
            reason = "The object is hidden; show it first"
        return reason

    def change(self, context: bpy.types.Context, obj: bpy.types.Object) -> str:
        if self.size <= 0:
            raise Refusal("a size above 0 is needed")
        choices, option = context.scene.spectral_tv, OPTIONS[self.option]
        setattr(choices, f"length_{self.option}", self.size)
        setattr(choices, option.switch[0], True)
        kept = getattr(choices, f"length_{self.option}")
        if not math.isclose(kept, self.size, rel_tol=ROUNDING):
            note(f"{option.label} goes no further than {lengths.told(kept)}")
        settings = choices.settings()
        finest, largest = settings.relative_scales()
        if settings.by.has_bands and finest >= largest:
            note("the finest size is not below the largest")
        return f"{option.label} is {lengths.told(kept)}"

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        if bpy.app.background or self.size > 0:
            return self.execute(context)
        end()
        obj = context.active_object
        self._subject = obj.name, obj.data.session_uid
        self._message = ""
        self._start: tuple[int, int] | None = None  # where the button was pressed
        self._ring = Ring()
        self._ring.radius = getattr(context.scene.spectral_tv, f"length_{self.option}")
        type(self).running = self
        context.window.cursor_modal_set("EYEDROPPER")
        context.window_manager.modal_handler_add(self)
        self._show(context)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if type(self).running is not self:  # a file was loaded, or it was begun anew
            self.cancel(context)
            return {"CANCELLED"}
        obj = context.active_object
        is_same = obj is not None and (obj.name, obj.data.session_uid) == self._subject
        if not is_same or self.refusal(context) is not None:
            self.cancel(context)
            self.report({"WARNING"}, f"{self._subject[0]}: no size was picked, as it changed")
            return {"CANCELLED"}
        if event.type in ("ESC", "RIGHTMOUSE") and event.value == "PRESS":
            self.cancel(context)
            return {"CANCELLED"}
        view = view_under(context, event)
        if event.type == "LEFTMOUSE":
            return self._on_button(context, event, view)
        if event.type in ("MOUSEMOVE", "INBETWEEN_MOUSEMOVE"):
            if self._start is not None:
                self._drag(context, event)
            elif view is not None:
                self._hover(obj, view)
            self._show(context)
        elif not event.type.startswith(PASSED_ON) and view is not None:
            return {"RUNNING_MODAL"}
        return {"PASS_THROUGH"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Leave nothing behind; Blender calls it too when it ends the operator itself."""
        if type(self).running is self:
            end()

    def _on_button(
        self, context: bpy.types.Context, event: bpy.types.Event, view: View | None
    ) -> set[str]:
        if event.value in ("PRESS", "DOUBLE_CLICK"):
            if view is None:
                return {"PASS_THROUGH"}
            self._hover(context.active_object, view)
            if self._ring.middle is not None:
                self._start = event.mouse_x, event.mouse_y
                self._pixel, self._is_drawn = pixel(view, self._ring.middle), False
        elif event.value == "RELEASE" and self._start is not None:
            self.size = self._ring.radius
            self.cancel(context)
            return self.execute(context)
        self._show(context)
        return {"RUNNING_MODAL"}

    def _hover(self, obj: bpy.types.Object, view: View) -> None:
        """Have the ring be where the mouse is, if that is on the object."""
        self._message, self._ring.middle = "", None
        try:
            hit = on_ray(obj, *ray(view))
        except Refusal as error:
            self._message = str(error)
            return
        if hit is None:
            return
        polygon, place = hit
        normal = shown_mesh(obj).polygons[polygon].normal
        self._ring.middle = obj.matrix_world @ place
        turned = obj.matrix_world.to_3x3().inverted_safe().transposed() @ normal
        self._ring.normal = turned.normalized() if turned.length else Vector((0, 0, 1))

    def _drag(self, context: bpy.types.Context, event: bpy.types.Event) -> None:
        """Have the rim of the ring follow the mouse, once it is clear that it is dragged."""
        inputs, scale = context.preferences.inputs, context.preferences.system.ui_scale
        away = math.dist((event.mouse_x, event.mouse_y), self._start)
        self._is_drawn = self._is_drawn or away > inputs.drag_threshold_mouse * scale
        if self._is_drawn and away:
            self._ring.radius = away * self._pixel

    def _show(self, context: bpy.types.Context) -> None:
        """Draw the ring, and say what is next."""
        label = OPTIONS[self.option].label
        length = lengths.told(self._ring.radius)
        text = (
            self._message or "Drag from the middle of a feature to its rim   |   Click: this size"
        )
        tell_next(f"{label}: {length}   |   {text}   |   Esc: leave")
        redraw_views()


def end() -> None:
    """End what is under way: a file is loaded, or the extension is disabled."""
    running = SPECTRAL_TV_OT_pick_size.running
    SPECTRAL_TV_OT_pick_size.running = None
    if running is not None:
        running._ring.remove()
        tell_next(None)
        redraw_views()
        for window in bpy.context.window_manager.windows:
            window.cursor_modal_restore()
