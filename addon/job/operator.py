"""Base classes of operators: one that changes something at once, and one that runs a job.

In scripts a job blocks. With a window it runs beside it, and Esc cancels it.
"""

import time
from collections.abc import Callable, Iterable
from typing import Any

import bpy
import spectral_tv
from bpy.props import FloatProperty
from spectral_tv.jobs.steps import Work
from spectral_tv.notes import gathered
from spectral_tv.refusal import Refusal

from ..scene.objects import refusal
from . import faults, jobs, timers
from .jobs import state_of
from .progress import cursor_progress, redraw_sidebars

# Seconds between two looks at the job; Esc is an event of its own and does not wait for them.
POLL = 0.05
# What keeps an operator from working; the message is for the user.
REFUSALS = (spectral_tv.MeshError, Refusal, MemoryError)


class SpectralTVWindowManager(bpy.types.PropertyGroup):
    """What the running job shows."""

    owner = bpy.types.WindowManager, "spectral_tv"

    progress: FloatProperty(name="Progress", min=0, max=1, subtype="FACTOR")


class Refusing:
    """An operator that says why it cannot run."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        """Why it cannot run now, in a sentence for the user; None if it can."""
        raise NotImplementedError

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        reason = cls.refusal(context)
        if reason is not None:
            cls.poll_message_set(reason)
        return reason is None

    def refuse(self, error: Exception, subject: bpy.types.ID | None) -> set[str]:
        """Report an error, and that nothing was done."""
        self.report({"ERROR"}, str(error) if subject is None else f"{subject.name}: {error}")
        return {"CANCELLED"}

    def tell(self, subject: bpy.types.ID, done: str | None, notes: Iterable[str]) -> set[str]:
        """Report what was done, and what was noted."""
        if done:
            self.report({"INFO"}, f"{subject.name}: {done}")
        for text in dict.fromkeys(notes):
            self.report({"WARNING"}, f"{subject.name}: {text}")
        return {"FINISHED"}


class ChangeOperator(Refusing):
    """An operator that changes the active object at once."""

    def change(self, context: bpy.types.Context, obj: bpy.types.Object) -> str | None:
        """Do it, and say what was done where that is not seen.

        Raises Refusal or spectral_tv.MeshError if it cannot be done.
        """
        raise NotImplementedError

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Do it, and tell what is worth telling."""
        obj = context.active_object
        try:
            with gathered() as notes:
                done = self.change(context, obj)
        except REFUSALS as error:
            return self.refuse(error, obj)
        return self.tell(obj, done, notes)


class JobOperator(Refusing):
    """An operator whose work is a job.

    A subclass reads what it works on in `prepare`, starts the job in `start`, and writes the result
    in `write`.
    """

    # What the user sees while it runs, before the object's name.
    working: str

    def prepare(self, obj: bpy.types.Object) -> Any:
        """Read of the subject what the work needs; raises Refusal or spectral_tv.MeshError."""
        raise NotImplementedError

    def start(self, prepared: Any) -> Work:
        """Start the work in a thread."""
        raise NotImplementedError

    def write(self, obj: bpy.types.Object, prepared: Any, result: Any) -> str:
        """Write the result and say what was done."""
        raise NotImplementedError

    def recall(self, _prepared: Any) -> Any:
        """The result, if it is known without work."""
        return None

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
        return state_of(subject)

    @staticmethod
    def shared(obj: bpy.types.ID) -> str:
        """Whom else the result concerns, to be added to what was done."""
        if obj.data.users < 2:
            return ""
        return f"; {obj.data.users} objects share this mesh and its shape keys"

    @classmethod
    def refusal(cls, context: bpy.types.Context) -> str | None:
        return cls.unusable(cls.subject(context))

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not super().poll(context):
            return False
        if jobs.running() is not None:
            cls.poll_message_set(f"{jobs.running().message}; Esc cancels it")
        return jobs.running() is None

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Run to completion: in scripts, in the background, and on Adjust Last Operation."""
        return self._run(context, self._wait)

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Run in a thread; the window stays alive and Esc cancels."""
        return self._run(context, self._wait if bpy.app.background else self._watch)

    def _run(self, context: bpy.types.Context, work: Callable[..., Any]) -> set[str]:
        """Begin; ``work`` returns the result, or None where that will come."""
        self._started = time.perf_counter()
        obj = None
        try:
            obj = self.chosen(context)
            with faults.kept(obj), gathered() as self._notes:
                prepared = self.prepare(obj)
            result = self.recall(prepared)
            if result is None:
                result = work(context, obj, prepared)
        except REFUSALS as error:
            return self.refuse(error, obj)
        return {"RUNNING_MODAL"} if result is None else self._finish(obj, prepared, result)

    def _wait(self, context: bpy.types.Context, _obj: bpy.types.ID, prepared: Any) -> Any:
        with cursor_progress(context) as progress:
            return self.start(prepared).result(progress)

    def _watch(self, context: bpy.types.Context, obj: bpy.types.ID, prepared: Any) -> None:
        message = f"{self.working} {obj.name}"
        self._mine = jobs.start(self.start(prepared), obj.name, self.state(obj), message)
        self._prepared = prepared
        manager = context.window_manager
        manager.spectral_tv.progress = 0
        self._timer = timers.add(context, POLL)
        manager.modal_handler_add(self)
        redraw_sidebars(context)

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
        timers.remove(self._timer)
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
        except (*REFUSALS, RuntimeError) as error:
            return self.refuse(error, obj)
        return self._finish(obj, prepared, result)

    def _finish(self, obj: bpy.types.Object, prepared: Any, result: Any) -> set[str]:
        try:
            with gathered() as later:
                done = self.write(obj, prepared, result)
        except (Refusal, MemoryError) as error:
            return self.refuse(error, obj)
        seconds = time.perf_counter() - self._started
        text = f"{done} in {seconds:.1f} s{self.shared(obj)}"
        return self.tell(obj, text, [*self._notes, *later])


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
