"""The operator that makes a pin and a handle of what is clicked on."""

import math

import bpy
from bpy.props import BoolProperty, CollectionProperty, FloatProperty, FloatVectorProperty
from mathutils import Vector
from spectral_tv.notes import gathered, note
from spectral_tv.refusal import Refusal

from ..drawing.pointing import PASSED_ON, View, on_ray, pixel, ray, tell_next, view_under
from ..job.operator import REFUSALS, ChangeOperator
from ..scene.objects import refusal
from ..scene.weights import add_group
from . import constraints, empties, overlay, picking
from . import strokes as stroking
from .deform_operator import SPECTRAL_TV_OT_deform
from .live_operator import SPECTRAL_TV_OT_deform_live


class SpectralTVPatch(bpy.types.PropertyGroup):
    """A disc on the surface of an object, with the name of a vertex group; empty is the usual."""

    point: FloatVectorProperty(
        name="Point", subtype="XYZ", unit="LENGTH", description="Its middle, in the world"
    )
    radius: FloatProperty(
        name="Radius", unit="LENGTH", min=0,
        description="Along the surface. 0 is a tenth of the object's size"
    )  # fmt: skip


class SPECTRAL_TV_OT_hold_and_pull(ChangeOperator, bpy.types.Operator):
    """Click on what stays, then on what moves; drag outwards for more of it. Makes a pin and a
    handle, and an empty to move that by"""

    bl_idname = "spectral_tv.hold_and_pull"
    bl_label = constraints.HOLD_AND_PULL

    held: CollectionProperty(
        type=SpectralTVPatch, name="Held", options={"SKIP_SAVE"},
        description="Places on the surface that stay"
    )  # fmt: skip
    pulled: CollectionProperty(
        type=SpectralTVPatch, name="Pulled", options={"SKIP_SAVE"},
        description="Places on the surface that move, each with an empty of its own"
    )  # fmt: skip
    live: BoolProperty(
        name="Live", default=True, options={"SKIP_SAVE"},
        description="Deform while the empty is moved; without a window nothing is dragged"
    )  # fmt: skip

    # The one that is under way.
    running: "SPECTRAL_TV_OT_hold_and_pull | None" = None

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        obj = context.active_object
        reason = refusal(obj)
        if reason is None and obj.mode != "OBJECT":
            reason = f"Leave {obj.mode.replace('_', ' ').title()} Mode first"
        if reason is None and not obj.visible_get():
            reason = "The object is hidden; show it first"
        return reason

    def change(self, context: bpy.types.Context, obj: bpy.types.Object) -> str:
        if not self.held and not self.pulled:
            raise Refusal("nothing is given to hold or to pull")
        patches = picking.Patches(obj)
        strokes = stroking.Strokes(patches)
        for is_pulled, given in ((False, self.held), (True, self.pulled)):
            for each in given:
                spread = patches.nearest(obj, Vector(each.point))
                strokes.begin(spread, is_pulled, each.radius, each.name)
                strokes.end()
        return _constrain(context, obj, strokes)

    def draw(self, _context: bpy.types.Context) -> None:
        """Lay out Adjust Last Operation."""
        self.layout.use_property_split = True
        for label, given in (("Held", self.held), ("Pulled", self.pulled)):
            for each in given:
                self.layout.prop(each, "radius", text=f"{label} Radius")

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        if bpy.app.background or self.held or self.pulled:
            return self.execute(context)
        end()
        obj = context.active_object
        try:
            with gathered() as self._notes:
                self._strokes = stroking.Strokes(picking.Patches(obj))
        except REFUSALS as error:
            return self.refuse(error, obj)
        self._subject = obj.name, _counts(obj)
        self._is_pulling = False
        self._message = ""
        type(self).running = self
        context.window.cursor_modal_set("CROSSHAIR")
        context.window_manager.modal_handler_add(self)
        self._show(obj)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if type(self).running is not self:  # a file was loaded, or it was begun anew
            self.cancel(context)
            return {"CANCELLED"}
        obj = bpy.data.objects.get(self._subject[0])
        if obj is None or obj != context.active_object or _counts(obj) != self._subject[1] or (
            self.refusal(context) is not None
        ):  # fmt: skip
            self.cancel(context)
            self.report({"WARNING"}, f"{self._subject[0]}: nothing was made, as it changed")
            return {"CANCELLED"}
        if event.type in ("ESC", "RIGHTMOUSE") and event.value == "PRESS":
            self.cancel(context)
            self.report({"INFO"}, "Cancelled; nothing was changed")
            return {"CANCELLED"}
        self._message = "" if event.value in ("PRESS", "DOUBLE_CLICK") else self._message
        if event.type == "LEFTMOUSE":
            return self._on_button(context, obj, event)
        if event.type == "MOUSEMOVE" and self._strokes.last is not None:
            self._drag(context, event)
            self._show(obj)
        elif event.value == "PRESS" and self._is_step_back(event):
            self._take_back()
            self._show(obj)
        elif event.value == "PRESS" and event.type in ("RET", "NUMPAD_ENTER"):
            return self._on_enter(context, obj)
        elif event.type.startswith(PASSED_ON) or view_under(context, event) is None:
            return {"PASS_THROUGH"}
        return {"RUNNING_MODAL"}

    def cancel(self, _context: bpy.types.Context) -> None:
        """Leave nothing behind; Blender calls it too when it ends the operator itself."""
        self._strokes = None  # Blender keeps the last operators
        if type(self).running is self:
            end()

    def _on_button(
        self, context: bpy.types.Context, obj: bpy.types.Object, event: bpy.types.Event
    ) -> set[str]:
        if event.value in ("PRESS", "DOUBLE_CLICK"):
            view = view_under(context, event)
            if view is None:
                return {"PASS_THROUGH"}
            try:
                self._press(obj, view, event)
            except Refusal as error:
                self._message = str(error)
        elif event.value == "RELEASE" and self._strokes.last is not None:
            stroke = self._strokes.last
            given = (self.pulled if stroke.is_pulled else self.held).add()
            given.point, given.radius = self._point, stroke.radius
            self._strokes.end()
            self._is_pulling = True
            if stroke.is_pulled:
                return self._finish(context, obj)
        self._show(obj)
        return {"RUNNING_MODAL"}

    def _press(self, obj: bpy.types.Object, view: View, event: bpy.types.Event) -> None:
        """Begin a patch where the mouse is; raises Refusal if nothing can be taken there."""
        hit = on_ray(obj, *ray(view))
        if hit is None:
            raise Refusal(f"That missed {obj.name!r}")
        spread = self._strokes.patches.around(obj, *hit)
        self._strokes.begin(spread, self._is_pulling and not event.shift)
        self._point = obj.matrix_world @ hit[1]
        self._start, self._pixel = (event.mouse_x, event.mouse_y), pixel(view, self._point)
        self._is_drawn = False

    def _drag(self, context: bpy.types.Context, event: bpy.types.Event) -> None:
        """Have the rim of the patch follow the mouse, once it is clear that it is dragged."""
        inputs, scale = context.preferences.inputs, context.preferences.system.ui_scale
        away = math.dist((event.mouse_x, event.mouse_y), self._start)
        self._is_drawn = self._is_drawn or away > inputs.drag_threshold_mouse * scale
        if self._is_drawn:
            self._strokes.grow(away * self._pixel)

    def _on_enter(self, context: bpy.types.Context, obj: bpy.types.Object) -> set[str]:
        """Go on without a pin, or end without a handle."""
        if self._is_pulling and self.held:
            return self._finish(context, obj)
        self._is_pulling = True
        self._show(obj)
        return {"RUNNING_MODAL"}

    @staticmethod
    def _is_step_back(event: bpy.types.Event) -> bool:
        return event.type == "BACK_SPACE" or (event.type == "Z" and (event.ctrl or event.oskey))

    def _take_back(self) -> None:
        if self._strokes.take_back():
            self.held.remove(len(self.held) - 1)
        self._is_pulling = len(self.held) > 0

    def _finish(self, context: bpy.types.Context, obj: bpy.types.Object) -> set[str]:
        strokes, notes = self._strokes, self._notes
        self.cancel(context)
        try:
            with gathered() as later:
                done = _constrain(context, obj, strokes)
        except REFUSALS as error:
            return self.refuse(error, obj)
        if self.pulled and not (self.live and _follow(context, obj)):
            done += f", and press {SPECTRAL_TV_OT_deform.bl_label} for {obj.name!r}"
        return self.tell(obj, done, [*notes, *later])

    def _show(self, obj: bpy.types.Object) -> None:
        """Draw what is picked, and say what is next."""
        overlay.pick(obj, self._strokes.picked(len(obj.data.vertices)))
        if self._strokes.last is not None:
            text = f"Drag outwards for more   Radius: {self._strokes.last.radius:.3g}"
        elif self._is_pulling:
            text = "Click what moves   |   Shift-click: stays too   |   "
            text += "Enter: only hold   |   " if self.held else ""
            text += "Backspace: take back"
        else:
            text = "Click what stays   |   Drag outwards: more of it   |   Enter: hold nothing more"
        message = f"{self._message}   |   " if self._message else ""
        tell_next(f"{constraints.HOLD_AND_PULL}: {message}{text}   |   Esc: cancel")


def end() -> None:
    """End what is under way: a file is loaded, or the extension is disabled."""
    running = SPECTRAL_TV_OT_hold_and_pull.running
    SPECTRAL_TV_OT_hold_and_pull.running = None
    if running is not None:
        overlay.pick(None, None)
        tell_next(None)
        for window in bpy.context.window_manager.windows:
            window.cursor_modal_restore()


def _counts(obj: bpy.types.Object) -> tuple[int, int, int]:
    return obj.data.session_uid, len(obj.data.vertices), len(obj.data.loops)


def _constrain(
    context: bpy.types.Context, obj: bpy.types.Object, strokes: "stroking.Strokes"
) -> str:
    """Make a pin of all that is held, and a handle of each that is pulled; select the last."""
    labels = {kind: label for kind, label, *_ in constraints.KINDS}
    made, done = None, []
    for kind, name, vertices in strokes.groups():
        group = add_group(obj, name or labels[kind])
        group.add(vertices.tolist(), 1.0, "REPLACE")
        made = empties.constrain(obj, group.name, kind)
        done.append(f"{len(vertices)} vertices {'stay' if kind == 'PIN' else 'move'}")
    if strokes.left_out:
        note(f"{strokes.left_out} picked vertices are left out, as they are held or pulled already")
    if made.target is not None:
        for each in context.selected_objects:
            each.select_set(False)
        made.target.select_set(True)
        context.view_layer.objects.active = made.target
        done.append(f"press G to move {made.target.name!r}")
    return ", ".join(done)


def _follow(context: bpy.types.Context, obj: bpy.types.Object) -> bool:
    """Have the mesh follow at once, and tell whether it can."""
    live = SPECTRAL_TV_OT_deform_live.running
    if live is not None:
        return live.object_name == obj.name
    with context.temp_override(active_object=obj):
        if not bpy.ops.spectral_tv.deform_live.poll():
            return False
        return "RUNNING_MODAL" in bpy.ops.spectral_tv.deform_live("INVOKE_DEFAULT")
