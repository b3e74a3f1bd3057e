"""At Once: the active object is decomposed anew when its settings are changed in the sidebar.

A change is followed after a short pause; a new one ends what runs. The work is that of the button,
beside the window, and Esc cancels it.
"""

from collections.abc import Callable

import bpy
from spectral_tv.bands.settings import Settings
from spectral_tv.later import uuid

from ..drawing.sidebar import say
from ..drawing.views import redraw_views
from ..job import jobs
from ..job.jobs import Running
from ..options.properties import properties_of
from ..scene import listening
from ..scene.objects import refusal
from ..scene.records import record_of
from . import at_once_plan, decompose, properties, whole_change
from .take_settings import SPECTRAL_TV_OT_take_settings

# Seconds without a change after which it is followed, and between two looks at what runs.
PAUSE, POLL = 0.3, 0.1
SWITCH = "at_once"


class _Now:
    """What is known of the last change."""

    # The scene, the mesh and the decomposition whose settings were changed, which of them, and
    # whether the switch was turned on for it.
    scene = ""
    subject: tuple = ()
    changed: frozenset[str] = frozenset()
    is_new = False
    # The change, what has to be done still, and what is being done.
    change = ""
    stages: "tuple[at_once_plan.Stage, ...]" = ()
    stage: "at_once_plan.Stage | None" = None
    job: Running | None = None
    is_previewed = False
    # What the panel says of it.
    told = ""


def is_active() -> bool:
    """Whether something of it is under way."""
    return _Now.job is not None or bpy.app.timers.is_registered(_begin)


def take(scene: bpy.types.Scene, *names: str) -> bool:
    """Take note that options of a scene were changed; tells whether something is to be done."""
    end()
    choices, obj = scene.spectral_tv, bpy.context.view_layer.objects.active
    whole_change.give_way(_Now.change)
    _Now.change = _Now.told = ""
    whole_change.mark(scene, "", "")
    if not choices.at_once or scene != bpy.context.scene:
        return False
    _Now.scene = scene.name
    if _subject(obj) != _Now.subject:
        _Now.subject, _Now.changed, _Now.is_new = _subject(obj), frozenset(), False
    if SWITCH in names:
        _Now.changed, _Now.is_new = at_once_plan.options_of_all(), True
    _Now.changed |= {*names} - {SWITCH}
    if at_once_plan.waiting(obj, choices.settings(), _Now.changed, _Now.is_new) is not None:
        return False
    planned = at_once_plan.plan(obj, choices.settings(), _Now.changed)
    _tell(planned.told)
    if not planned.stages:  # it is so already, or left to the button
        _Now.changed = _Now.changed if planned.told else frozenset()
        return False
    _Now.change = uuid.uuid4().hex
    whole_change.mark(scene, _Now.change, whole_change.MADE)
    return True


def follow() -> None:
    """Do what is to be done for the last change: begin with it, where there is a window."""
    scene, obj = bpy.context.scene, bpy.context.view_layer.objects.active
    choices = scene.spectral_tv
    if not _Now.change or not choices.at_once:
        return
    if at_once_plan.waiting(obj, choices.settings(), _Now.changed, _Now.is_new) is not None:
        whole_change.mark(scene, "", "")
        return
    planned = at_once_plan.plan(obj, choices.settings(), _Now.changed)
    _Now.stages = planned.stages
    _tell(planned.told)
    _Now.is_previewed = False
    _next()


def end() -> None:
    """End what is under way; what was written stays."""
    for each in (_begin, _watch):
        if bpy.app.timers.is_registered(each):
            bpy.app.timers.unregister(each)
    if _Now.job is not None and jobs.running() is _Now.job:
        jobs.finish()
    _Now.job = _Now.stage = None
    _Now.stages = ()


def forget() -> None:
    """End it, and let go of all that is known."""
    end()
    _Now.subject, _Now.changed, _Now.is_new = (), frozenset(), False
    _Now.change = _Now.told = ""
    whole_change.forget()


def start() -> None:
    """Listen to undo; loading a file ends it."""
    listening.listen(_handlers())
    whole_change.start()


def stop() -> None:
    """Listen no more."""
    listening.ignore(_handlers())
    whole_change.stop()


def draw(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw what is done, or why nothing is."""
    choices, obj = context.scene.spectral_tv, context.active_object
    if not choices.at_once:
        return
    is_same = _subject(obj) == _Now.subject
    if _Now.job is not None and _Now.stage is not None and jobs.running() is _Now.job:
        settings = _Now.stage.settings
        if _Now.stage.is_preview:
            say(layout, context, f"At first a preview with {settings.steps} steps", "TIME")
        elif _Now.is_previewed:
            say(layout, context, "A preview is shown; this makes the whole of it", "TIME")
        return
    names = _Now.changed if is_same else frozenset()
    settings, record = choices.settings(), record_of(obj)
    reason = at_once_plan.waiting(obj, settings, names, is_same and _Now.is_new)
    if reason is not None and record is not None and refusal(obj) is None:
        say(layout, context, reason, "INFO")
        if at_once_plan.foreign(record, settings, names):
            layout.operator(SPECTRAL_TV_OT_take_settings.bl_idname, icon="COPYDOWN")
    elif is_same and _Now.told:
        say(layout, context, _Now.told, "INFO")


def _subject(obj: bpy.types.Object | None) -> tuple:
    record = record_of(obj)
    if obj is None or obj.data is None:
        return ()
    return obj.data.session_uid, "" if record is None else record.identifier


def _tell(text: str) -> None:
    """Have the panel say something."""
    _Now.told = text
    redraw_views()


def _notice(scene: bpy.types.Scene, *names: str) -> None:
    """A property of the sidebar was changed."""
    if bpy.app.background:
        return
    if take(scene, *names):
        bpy.app.timers.register(_begin, first_interval=PAUSE)


def _begin() -> float | None:
    """Begin, unless Blender is busy."""
    screens = [window.screen for window in bpy.context.window_manager.windows]
    is_busy = bpy.app.is_job_running("RENDER") or jobs.running() is not None
    if is_busy or any(screen.is_animation_playing for screen in screens):
        return PAUSE
    _in_place(follow)
    return None


def _in_place(work: Callable[[], None]) -> None:
    """Work in a window with the scene, in its 3D view if it has one; end all without a window."""
    windows = [each for each in bpy.context.window_manager.windows if each.scene.name == _Now.scene]
    if not windows:
        end()
        return
    areas = [each for each in windows[0].screen.areas if each.type == "VIEW_3D"]
    place = {"area": areas[0]} if areas else {}
    with bpy.context.temp_override(window=windows[0], **place):
        work()


def _next() -> None:
    """Do the next thing that is to be done."""
    while _Now.stages:
        if _subject(bpy.context.view_layer.objects.active) != _Now.subject:
            _stop("")
            return
        _Now.stage, *rest = _Now.stages
        _Now.stages = tuple(rest)
        # What the user does meanwhile has a step of undo that is no part of the change.
        whole_change.mark(bpy.context.scene, _Now.change, whole_change.UNDER_WAY)
        try:
            status = _run(_Now.stage)
        except RuntimeError as error:  # it was reported
            _stop(str(error).removeprefix("Error: ").strip())
            return
        if status == {"RUNNING_MODAL"}:
            _Now.job = jobs.running()
            bpy.app.timers.register(_watch, first_interval=POLL)
            return
        if status != {"FINISHED"}:
            _stop("")
            return
    _Now.stage = None


def _run(stage: "at_once_plan.Stage") -> set[str]:
    if stage.is_cut:
        _written(bpy.context.view_layer.objects.active, stage.settings)
        count = stage.settings.band_count
        return bpy.ops.spectral_tv.cut("EXEC_DEFAULT", True, bands=count)
    return bpy.ops.spectral_tv.decompose("INVOKE_DEFAULT", True, **properties_of(stage.settings))


def _stop(told: str) -> None:
    end()
    _tell(told)
    whole_change.mark(bpy.context.scene, "", "")


def _watch() -> float | None:
    """Look whether what runs may go on, and whether it is over."""
    obj = bpy.context.view_layer.objects.active
    if jobs.running() is _Now.job:
        if obj is not None and obj.mode == "OBJECT":
            return POLL
        _stop("Stopped, as the mode is another one")
    elif _Now.stage is None:  # it was written
        _Now.job = None
        _in_place(_next)
    else:
        shown = ". A preview is shown" if _Now.is_previewed else ""
        _stop(f"Stopped{shown}; press the button, or change a setting")
    return None


def _written(obj: bpy.types.Object, settings: Settings) -> None:
    """Bands of an object were written, by this or by the button."""
    scene = bpy.context.scene
    stage = _Now.stage
    if stage is None or settings.into != stage.settings.into:
        _Now.subject, _Now.changed, _Now.told = (), frozenset(), ""
        whole_change.mark(scene, "", "")
        return
    _Now.subject = _subject(obj)
    is_last = not _Now.stages
    if stage.is_preview:
        _Now.is_previewed = True
        _Now.changed |= {"steps", "accuracy"}
    elif is_last:
        _Now.changed, _Now.is_new = frozenset(), False
    whole_change.mark(scene, _Now.change, whole_change.DONE if is_last else whole_change.PREVIEWED)
    _Now.stage = None


def _handlers() -> list[listening.Handler]:
    handlers = bpy.app.handlers
    return [(handlers.undo_post, _undone), (handlers.redo_post, _undone)]


def _undone(*_arguments: object) -> None:
    """What was changed is not any more."""
    end()
    _Now.subject, _Now.changed, _Now.change, _Now.told = (), frozenset(), "", ""


properties.CHANGED.append(_notice)
decompose.WRITTEN.append(_written)
