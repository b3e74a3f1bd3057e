"""The base class and the rows of panels that start work."""

from collections.abc import Callable

import bpy
from spectral_tv.options.estimates import Needs

from ..job import faults, jobs
from ..job.operator import SPECTRAL_TV_OT_cancel
from ..job.select_faulty import SPECTRAL_TV_OT_select_faulty
from ..options import rows
from ..options.properties import give
from ..scene.objects import is_mesh, refusal, selected_meshes
from .sidebar import Sidebar, say

# How much higher than others the buttons are that start work.
TALL = 1.4


class WorkPanel(Sidebar):
    """What is chosen, and a button that starts work; while it runs, how far it is."""

    # The scene's property that has what is chosen, if any.
    kept = ""

    def rows(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        self.choices(context, layout)
        if jobs.running() is None:
            self.actions(context, layout)
        else:
            _draw_progress(layout, context)

    def choices(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draw what is chosen."""
        if self.kept:
            choices = getattr(context.scene, self.kept)
            rows.draw(layout, choices, *choices.columns)

    def actions(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draw what can be done."""
        raise NotImplementedError


class MeshPanel(WorkPanel):
    """One that is there for meshes, closed at first."""

    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return is_mesh(context.active_object)


def draw_button(
    layout: bpy.types.UILayout,
    operator: type[bpy.types.Operator],
    icon: str,
    choices: bpy.types.PropertyGroup | None = None,
    *,
    is_tall: bool = True,
    **more: str,
) -> bpy.types.OperatorProperties:
    """Draw the button of an operator, which gets what was chosen."""
    row = layout.row()
    row.scale_y = TALL if is_tall else 1.0
    button = row.operator(operator.bl_idname, icon=icon, **more)
    if choices is not None:
        give(choices, button, operator)
    return button


def draw_fault(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw why vertices of the active object were refused, and a button that selects them."""
    fault = faults.of(context.active_object)
    if fault is not None:
        say(layout, context, f"Refused: {fault.message}", "ERROR")
        layout.operator(SPECTRAL_TV_OT_select_faulty.bl_idname, icon="RESTRICT_SELECT_OFF")


def draw_needs(layout: bpy.types.UILayout, context: bpy.types.Context, needs: Needs) -> None:
    """Draw what the work that a button starts will take, where that is worth a word."""
    text = needs.told()
    if text is not None:
        say(layout, context, text, "TIME" if needs.fits else "ERROR")


def draw_selection(
    layout: bpy.types.UILayout, context: bpy.types.Context, shared: str, needs: Callable[..., Needs]
) -> None:
    """Draw that all selected meshes get the same ``shared``, and what the work needs.

    ``needs`` takes the numbers of their vertices.
    """
    reason = refusal(context.active_object)
    objects = selected_meshes(context)
    if reason is not None:
        say(layout, context, reason, "INFO")
    elif len(objects) > 1:
        say(layout, context, f"{len(objects)} meshes get the same {shared}", "INFO")
    meshes = {obj.data for obj in objects}  # a shared one is split once
    draw_needs(layout, context, needs(*(len(mesh.vertices) for mesh in meshes)))


def _draw_progress(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw what the job under way does, how far it is, and a button that cancels it."""
    progress = context.window_manager.spectral_tv.progress
    row = layout.row(align=True)
    row.scale_y = TALL
    row.progress(text=f"{jobs.running().message} ({progress:.0%})", factor=progress)
    row.operator(SPECTRAL_TV_OT_cancel.bl_idname, text="", icon="CANCEL")
