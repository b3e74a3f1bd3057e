"""The operator that splits the active mesh into bands."""

import time
from typing import Any

import bpy
import spectral_tv

from .. import jobs
from ..bands import add_bands, prepare, recall
from ..objects import Refusal, refusal
from ..properties import DecompositionProperties
from ..surface import Surface
from ._progress import cursor_progress, redraw_sidebars

# Seconds between two looks at the job; Esc is an event of its own and does not wait for them.
POLL = 0.05


class SPECTRAL_TV_OT_decompose(DecompositionProperties, bpy.types.Operator):
    """Split the active mesh into bands of detail, one shape key per band"""

    bl_idname = "spectral_tv.decompose"
    bl_label = "Decompose into Bands"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        reason = refusal(context.active_object)
        if reason is None and jobs.running() is not None:
            reason = "A decomposition is running; Esc cancels it"
        if reason is not None:
            cls.poll_message_set(reason)
        return reason is None

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Run to completion: in scripts, in the background, and on Adjust Last Operation."""
        self._started = time.perf_counter()
        obj = context.active_object
        try:
            surface, arguments = prepare(obj, self.settings())
            split = recall(surface, arguments)
            if split is None:
                with cursor_progress(context) as progress:
                    split = spectral_tv.decompose(surface.mesh, **arguments, progress=progress)
        except (spectral_tv.MeshError, Refusal) as error:
            self.report({"ERROR"}, f"{obj.name}: {error}")
            return {"CANCELLED"}
        return self._write(obj, surface, arguments, split)

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Run in a thread; the window stays alive and Esc cancels."""
        if bpy.app.background:
            return self.execute(context)
        self._started = time.perf_counter()
        obj = context.active_object
        try:
            surface, arguments = prepare(obj, self.settings())
            split = recall(surface, arguments)
            if split is not None:
                return self._write(obj, surface, arguments, split)
            jobs.start(spectral_tv.start_decompose(surface.mesh, **arguments), obj)
        except (spectral_tv.MeshError, Refusal) as error:
            self.report({"ERROR"}, f"{obj.name}: {error}")
            return {"CANCELLED"}
        self._surface, self._arguments = surface, arguments
        manager = context.window_manager
        manager.spectral_tv.progress = 0
        manager.spectral_tv.message = f"Decomposing {obj.name}"
        self._timer = manager.event_timer_add(POLL, window=context.window)
        manager.modal_handler_add(self)
        redraw_sidebars(context)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        running = jobs.running()
        if event.type == "ESC" and event.value == "PRESS":
            self.cancel(context)
            self.report({"INFO"}, "Decomposition cancelled")
            return {"CANCELLED"}
        if running is None:  # by the button, or by loading a file
            self.cancel(context)
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
        jobs.finish()
        if self._timer is not None:
            context.window_manager.event_timer_remove(self._timer)
            self._timer = None
        redraw_sidebars(context)

    _timer = None

    def _collect(self, context: bpy.types.Context, running: jobs.Running) -> set[str]:
        """Write the result of a finished job, if its object is still what it was."""
        self.cancel(context)
        obj = bpy.data.objects.get(running.object_name)
        if refusal(obj) is not None or jobs.state_of(obj) != running.state:
            message = "changed while it was decomposed; nothing was written"
            self.report({"WARNING"}, f"{running.object_name}: {message}")
            return {"CANCELLED"}
        try:
            split = running.job.result()
        except (spectral_tv.MeshError, RuntimeError) as error:
            self.report({"ERROR"}, f"{obj.name}: {error}")
            return {"CANCELLED"}
        return self._write(obj, self._surface, self._arguments, split)

    def _write(
        self,
        obj: bpy.types.Object,
        surface: Surface,
        arguments: dict[str, Any],
        split: spectral_tv.Decomposition,
    ) -> set[str]:
        add_bands(obj, self.settings(), surface, arguments, split)
        seconds = time.perf_counter() - self._started
        message = f"{obj.name}: {self.bands} bands of {self.method} added in {seconds:.1f} s"
        if obj.data.users > 1:
            message += f"; {obj.data.users} objects share this mesh and its shape keys"
        self.report({"INFO"}, message)
        return {"FINISHED"}

    def draw(self, _context: bpy.types.Context) -> None:
        """Lay out Adjust Last Operation."""
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "method")
        layout.prop(self, "bands")
        layout.prop(self, "steps")


class SPECTRAL_TV_OT_cancel(bpy.types.Operator):
    """Cancel the running decomposition; the mesh stays as it is"""

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


CLASSES = (SPECTRAL_TV_OT_decompose, SPECTRAL_TV_OT_cancel)
