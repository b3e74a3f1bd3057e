"""The operator that deforms while handles are dragged."""

import bpy
from spectral_tv.notes import gathered

from ..job import faults, jobs, timers
from ..job.operator import REFUSALS, Refusing
from ..job.progress import redraw_sidebars
from . import deform, live

# Seconds between two looks at the handles.
POLL = 1 / 120


class SPECTRAL_TV_OT_deform_live(Refusing, bpy.types.Operator):
    """Deform while handles are moved: drag an empty, pose a bone or play the animation. Press
    again, or Esc, to end"""

    bl_idname = "spectral_tv.deform_live"
    bl_label = "Live"

    # The one that runs; pressing the button again ends it.
    running: "SPECTRAL_TV_OT_deform_live | None" = None
    # Why it waits for the user, in a sentence; empty while it follows.
    problem = ""
    # The fraction done of what it prepares; None while it follows.
    preparation: float | None = None

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        if cls.running is not None:
            return None
        reason = deform.follow_refusal(context.active_object)
        if reason is None and jobs.running() is not None:
            reason = f"{jobs.running().message}; Esc cancels it"
        if reason is None and bpy.app.background:
            reason = "There is nothing to drag without a window"
        return reason

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        cls = type(self)
        if cls.running is not None:
            cls.running.should_end = True
            return {"CANCELLED"}
        self.object_name = context.active_object.name
        self._told: set[str] = set()
        try:
            with faults.kept(context.active_object), gathered() as notes:
                self._live = live.LiveDeformation(context.active_object)
        except REFUSALS as error:
            return self.refuse(error, context.active_object)
        self._tell(notes)
        self.should_end = False
        cls.running = self
        self._timer = timers.add(context, POLL)
        context.window_manager.modal_handler_add(self)
        redraw_sidebars(context)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if type(self).running is not self:  # a file was loaded
            self.cancel(context)
            return {"CANCELLED"}
        if self.should_end or (event.type == "ESC" and event.value == "PRESS"):
            self.cancel(context)
            return {"FINISHED"}
        if event.type == "TIMER":
            try:
                with gathered() as notes:
                    self._live.update()
            except (*REFUSALS, RuntimeError) as error:
                self.cancel(context)
                self.report({"WARNING"}, f"{self.object_name}: no longer live: {error}")
                return {"FINISHED"}
            self._tell(notes)
            if self._live.preparation != self.preparation:
                self.preparation = self._live.preparation
                redraw_sidebars(context)
            if self._live.problem != self.problem:
                self.problem = self._live.problem
                if self.problem:
                    self.report({"WARNING"}, f"{self.object_name}: waiting: {self.problem}")
                redraw_sidebars(context)
        return {"PASS_THROUGH"}

    def _tell(self, notes: list[str]) -> None:
        """Report what was not told before."""
        for note in notes:
            if note not in self._told:
                self._told.add(note)
                self.report({"WARNING"}, f"{self.object_name}: {note}")

    def cancel(self, context: bpy.types.Context) -> None:
        """Leave the shape as it is; Blender calls it too when it ends the operator itself."""
        self._live.stop()
        self._live = None  # Blender keeps the last operators
        if type(self).running is self:
            type(self).running = None
        timers.remove(self._timer)
        redraw_sidebars(context)


def end() -> None:
    """End what runs: a file is loaded, or the extension is disabled."""
    running = SPECTRAL_TV_OT_deform_live.running
    if running is not None:
        running._live.stop()
    SPECTRAL_TV_OT_deform_live.running = None
