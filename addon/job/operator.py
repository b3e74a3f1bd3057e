"""What operators share whose work is a job: blocking in scripts, modal in a window."""

import time
from typing import Any

import bpy
import spectral_tv
from bpy.props import FloatProperty

from ..scene.notes import gathered
from ..scene.objects import Refusal, refusal
from . import faults, jobs
from . import timers as _timers
from .progress import cursor_progress, redraw_sidebars

# Seconds between two looks at the job; Esc is an event of its own and does not wait for them.
POLL = 0.05


class SpectralTVWindowManager(bpy.types.PropertyGroup):
    """What the running job shows."""

    progress: FloatProperty(name="Progress", min=0, max=1, subtype="FACTOR")


class JobOperator:
    """The four parts of such an operator, and the running of them."""

    # What the user sees while it runs, before the object's name.
    working: str

    def prepare(self, obj: bpy.types.Object) -> Any:
        """Read of the subject what the work needs; raises Refusal or spectral_tv.MeshError."""
        raise NotImplementedError

    def recall(self, _prepared: Any) -> Any:
        """The result, if it is known without work."""
        return None

    def work(self, prepared: Any, progress: Any) -> Any:
        """Do the work and return its result; ``progress`` takes the fraction done."""
        raise NotImplementedError

    def start(self, prepared: Any) -> spectral_tv.Job:
        """Start the same work in a thread."""
        raise NotImplementedError

    def write(self, obj: bpy.types.Object, prepared: Any, result: Any) -> str:
        """Write the result and say what was done."""
        raise NotImplementedError

    @classmethod
    def subject(cls, context: bpy.types.Context) -> bpy.types.ID | None:
        """What is worked on where nothing else is named."""
        return context.active_object

    def chosen(self, context: bpy.types.Context) -> bpy.types.ID:
        """What is worked on; raises Refusal if it cannot be."""
        return self.subject(context)

    @staticmethod
    def find(name: str) -> bpy.types.ID | None:
        """The subject of this name, fetched again."""
        return bpy.data.objects.get(name)

    @staticmethod
    def unusable(subject: bpy.types.ID | None) -> str | None:
        """Why a subject cannot be worked on, in a sentence for the user; None if it can."""
        return refusal(subject)

    @staticmethod
    def state(subject: bpy.types.ID) -> str:
        """Digest of all that a result depends on."""
        return jobs.state_of(subject)

    @staticmethod
    def shared(obj: bpy.types.ID) -> str:
        """Whom else the result concerns, to be added to what was done."""
        if obj.data.users < 2:
            return ""
        return f"; {obj.data.users} objects share this mesh and its shape keys"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        reason = cls.refusal(context)
        if reason is None and jobs.running() is not None:
            reason = f"{jobs.running().message}; Esc cancels it"
        if reason is not None:
            cls.poll_message_set(reason)
        return reason is None

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        """Why the operator cannot run now, in a sentence for the user."""
        return cls.unusable(cls.subject(context))

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Run to completion: in scripts, in the background, and on Adjust Last Operation."""
        self._started = time.perf_counter()
        obj = None
        try:
            obj = self.chosen(context)
            with faults.kept(obj), gathered() as self._notes:
                prepared = self.prepare(obj)
            result = self.recall(prepared)
            if result is None:
                with cursor_progress(context) as progress:
                    result = self.work(prepared, progress)
        except (spectral_tv.MeshError, Refusal, MemoryError) as error:
            self.report({"ERROR"}, f"{obj.name}: {error}" if obj is not None else str(error))
            return {"CANCELLED"}
        return self._finish(obj, prepared, result)

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Run in a thread; the window stays alive and Esc cancels."""
        if bpy.app.background:
            return self.execute(context)
        self._started = time.perf_counter()
        obj = None
        try:
            obj = self.chosen(context)
            with faults.kept(obj), gathered() as self._notes:
                prepared = self.prepare(obj)
            result = self.recall(prepared)
            if result is not None:
                return self._finish(obj, prepared, result)
            message = f"{self.working} {obj.name}"
            self._mine = jobs.start(self.start(prepared), obj.name, self.state(obj), message)
        except (spectral_tv.MeshError, Refusal, MemoryError) as error:
            self.report({"ERROR"}, f"{obj.name}: {error}" if obj is not None else str(error))
            return {"CANCELLED"}
        self._prepared = prepared
        manager = context.window_manager
        manager.spectral_tv.progress = 0
        self._timer = _timers.add(context, POLL)
        manager.modal_handler_add(self)
        redraw_sidebars(context)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        running = self._mine
        if jobs.running() is not running:  # ended by the button; another may run already
            self.cancel(context)
            return {"CANCELLED"}
        if event.type == "ESC" and event.value == "PRESS":
            self.cancel(context)
            self.report({"INFO"}, "Cancelled; nothing was changed")
            return {"CANCELLED"}
        if event.type == "TIMER":
            state, progress = context.window_manager.spectral_tv, running.job.progress
            if f"{progress:.0%}" != f"{state.progress:.0%}":  # drawing has its price
                state.progress = progress
                redraw_sidebars(context)
            if running.job.done:
                return self._collect(context, running)
        return {"PASS_THROUGH"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Leave nothing behind; Blender calls it too when it ends the operator itself."""
        if jobs.running() is self._mine:
            jobs.finish()
        _timers.remove(self._timer)
        # Blender keeps the last operators, for Adjust Last Operation; what they held is large.
        self._mine = self._prepared = None
        redraw_sidebars(context)

    def _collect(self, context: bpy.types.Context, running: jobs.Running) -> set[str]:
        """Write the result of a finished job, if its object is still what it was."""
        prepared = self._prepared
        self.cancel(context)
        obj = self.find(running.name)
        reason = None
        if obj is None:
            reason = "as it was removed or renamed in the meantime"
        elif self.unusable(obj) is not None:
            reason = f"as it cannot be now. {self.unusable(obj)}"
        elif self.state(obj) != running.state:
            reason = "as it changed in the meantime"
        if reason is not None:
            self.report({"WARNING"}, f"{running.name}: nothing was written, {reason}")
            return {"CANCELLED"}
        try:
            result = running.job.result()
        except (spectral_tv.MeshError, RuntimeError, MemoryError) as error:
            self.report({"ERROR"}, f"{obj.name}: {error}")
            return {"CANCELLED"}
        return self._finish(obj, prepared, result)

    def _finish(self, obj: bpy.types.Object, prepared: Any, result: Any) -> set[str]:
        try:
            with gathered() as later:
                done = self.write(obj, prepared, result)
        except (Refusal, MemoryError) as error:
            self.report({"ERROR"}, f"{obj.name}: {error}")
            return {"CANCELLED"}
        message = f"{obj.name}: {done} in {time.perf_counter() - self._started:.1f} s"
        self.report({"INFO"}, message + self.shared(obj))
        for note in dict.fromkeys([*self._notes, *later]):
            self.report({"WARNING"}, f"{obj.name}: {note}")
        return {"FINISHED"}


class SPECTRAL_TV_OT_cancel(bpy.types.Operator):
    """Cancel what is running; the mesh stays as it is"""

    bl_idname = "spectral_tv.cancel"
    bl_label = "Cancel"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        return jobs.running() is not None

    def execute(self, context: bpy.types.Context) -> set[str]:
        jobs.finish()
        redraw_sidebars(context)
        return {"FINISHED"}


CLASSES = (SPECTRAL_TV_OT_cancel,)
