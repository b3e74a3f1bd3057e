"""A deformation that follows its handles while they are dragged."""

from __future__ import annotations

import time
from typing import Any

import bpy
import spectral_tv
from spectral_tv.deformation.contact import Contact
from spectral_tv.deformation.solvers import follower_of
from spectral_tv.jobs.steps import Steps
from spectral_tv.later import np
from spectral_tv.options.declaring import in_force
from spectral_tv.refusal import Refusal

from ..scene.contents import digest
from ..scene.coordinates import coordinates
from ..scene.modifiers import symmetries
from ..scene.places import is_kept_up
from ..scene.surface import Reading
from . import results
from .constraints import deformation_of, followed_by, identified
from .deform import Deformable, follow_refusal, is_same_metric, metric_of
from .handles import group_weights

# So often a rough answer is drawn before the exact one is worked out.
MOST_ROUGH = 20
# Seconds between two looks at weights and vertices, and the least in terms of what a look takes.
LOOK = 0.25
LOOK_SHARE = 20
# Seconds between two looks at what runs in the background, where one waits for it.
WAIT = 1e-3
# Seconds for which Blender waits for a rough answer.
PATIENCE = 0.1


class LiveDeformation:
    """Keeps the shape key of one object up to date; `update` is called again and again."""

    # Why it waits for the user, in a sentence; empty while it follows.
    problem = ""

    def __init__(self, obj: bpy.types.Object) -> None:
        """Read ``obj``; raises Refusal or spectral_tv.MeshError if it cannot be deformed."""
        self._name = obj.name
        self._counts = _counts(obj)
        self._preparation: Steps[None] | None = None
        self._job: spectral_tv.Job | None = None
        self._check: Steps[Contact] | None = None
        self._is_shown = False
        self._read(obj)

    def update(self) -> bool:
        """Follow the handles, or refine if they rest; tells whether the shape changed.

        What takes long is done in the background, while Blender draws and listens to the user.
        What the user changes is read anew. Where that, or a handle, cannot be used, `problem` tells
        why, and the shape stays until it can. Raises Refusal or spectral_tv.MeshError if the object
        can no longer be deformed.
        """
        if self.is_dragging and not self._is_answered():
            return False  # what changed meanwhile is looked at then
        obj = bpy.data.objects.get(self._name)
        reason = "it was removed or renamed" if obj is None else follow_refusal(obj)
        if reason is not None:
            raise Refusal(reason)
        if _counts(obj) != self._counts:
            raise Refusal("its vertices or faces changed")
        try:
            if self._is_outdated(obj):
                self._read(obj)
            self._take_settings(obj)
            targets = self._current(obj)
        except (Refusal, spectral_tv.MeshError) as error:
            self.stop()
            self.problem, self._targets = str(error), None
            return False
        self.problem = ""
        return self._follow(obj, targets)

    @property
    def preparation(self) -> float | None:
        """The fraction done of what has to be prepared before it follows; None once it is."""
        return None if self._preparation is None else self._preparation.progress

    @property
    def is_dragging(self) -> bool:
        """Whether a rough answer is under way."""
        return self._asked is not None

    def settle(self) -> None:
        """Work the exact answer out and wait for it; raises Refusal if something is wrong."""
        while not self.is_settled or self._check is not None:
            self.update()
            if self.problem:
                raise Refusal(self.problem)
            time.sleep(WAIT)

    def stop(self) -> None:
        """Stop what runs in the background."""
        for job in (self._preparation, self._job, self._check):
            if job is not None:
                job.cancel()
        self._preparation, self._job, self._check, self.is_settled = None, None, None, False
        self._asked: np.ndarray | None = None

    def _read(self, obj: bpy.types.Object) -> None:
        """Read all of the object anew; what was read stays unknown if it cannot be used."""
        self.stop()
        self._targets: np.ndarray | None = None
        self._rough = 0
        self._settings = deformation_of(obj).settings()
        self._choices, self._metric, self._state = _choices(obj), metric_of(obj), self._look(obj)
        self._deformable: Deformable | None = None
        self._check_kept_up(obj)
        deformable = Deformable.read(obj)
        deformable.grips.targets(obj)
        self._follower = follower_of(deformable.grips.held(obj), self._settings)
        self._deformable = deformable

    def _take_settings(self, obj: bpy.types.Object) -> None:
        """Go on with what the user chose; read anew where that is needed."""
        settings = deformation_of(obj).settings()
        if self._deformable is None or in_force(settings) == in_force(self._settings):
            return
        self.stop()
        is_same = settings.algorithm == self._settings.algorithm and self._follower.is_ready
        if is_same and self._follower.take(settings):
            self._settings, self._targets = settings, None
        else:
            self._read(obj)

    def _is_outdated(self, obj: bpy.types.Object) -> bool:
        """Whether what was read is no longer so; looks at weights and vertices now and then."""
        if _choices(obj) != self._choices or not is_same_metric(metric_of(obj), self._metric):
            return True
        if time.monotonic() < self._next_look:
            return False
        return self._look(obj) != self._state or self._deformable is None

    def _look(self, obj: bpy.types.Object) -> str:
        started = time.monotonic()
        state = _state(obj)
        ended = time.monotonic()
        self._next_look = ended + max(LOOK, LOOK_SHARE * (ended - started))
        return state

    def _current(self, obj: bpy.types.Object) -> np.ndarray:
        if self._deformable is None:
            raise Refusal(self.problem)
        self._check_kept_up(obj)
        return self._deformable.grips.targets(obj)

    @staticmethod
    def _check_kept_up(obj: bpy.types.Object) -> None:
        hidden = [each.name for each, _ in followed_by(obj) if not is_kept_up(each)]
        if hidden:
            raise Refusal(
                f"Blender does not move what is hidden, {results.told(hidden)}; show it, or use "
                "Deform or Bake Animation"
            )

    def _follow(self, obj: bpy.types.Object, targets: np.ndarray) -> bool:
        if not self._follower.is_ready and not self._is_prepared():
            return False
        if self._targets is None or not np.array_equal(targets, self._targets):
            self._targets, self._rough = targets, 0
            if not self.is_dragging:
                self.stop()
                self._start_drag()
        if self.is_settled:
            self._look_at_check()
            return False
        if self._job is None:  # the handles rest, at least since the last look
            self._refine()
        if not self._job.done:
            return False
        result, self._job = self._job.result(), None
        if self._asked is None:
            self.is_settled = True
            self._check = self._follower.start_check(result)
        elif self._asked is not self._targets:
            self._start_drag()
        else:
            self._asked = None
            is_rough = self._follower.is_rough(result) and self._rough < MOST_ROUGH
            self._rough = self._rough + 1 if is_rough else 0
        self._write(obj, result)  # last, as what was started goes on meanwhile
        return True

    def _refine(self) -> None:
        if self._rough:
            self._start_drag()
        else:
            self._job = self._follower.start_settling(self._targets)

    def _start_drag(self) -> None:
        self._job, self._asked = self._follower.start_drag(self._targets), self._targets
        self._patience = time.monotonic() + PATIENCE

    def _is_answered(self) -> bool:
        """Whether the rough answer is there; waits for one that does not take long."""
        while not self._job.done:
            if time.monotonic() > self._patience:
                return False
            time.sleep(WAIT)
        return True

    def _is_prepared(self) -> bool:
        """Whether the follower is ready; starts to prepare it."""
        if self._preparation is None:
            self._preparation = self._follower.prepare()
        if not self._preparation.done:
            return False
        preparation, self._preparation = self._preparation, None
        preparation.result()
        return True

    def _look_at_check(self) -> None:
        """Note what is wrong with what settled, once that is known."""
        if self._check is not None and self._check.done:
            check, self._check = self._check, None
            check.result().note()

    def _write(self, obj: bpy.types.Object, result: Any) -> None:
        results.write(obj, self._deformable.displacement(result))
        if not self._is_shown:  # once: the user may mute it to compare
            results.show(obj)
            self._is_shown = True


def _counts(obj: bpy.types.Object) -> tuple[int, int]:
    return len(obj.data.vertices), len(obj.data.loops)


def _choices(obj: bpy.types.Object) -> tuple:
    """What the user chose of ``obj``, apart from what is read for every shape anyway."""
    is_posed, found = deformation_of(obj).algorithm == "POSE", identified(obj).items()
    return (
        obj.data.session_uid,
        Reading.of_scene(),
        *((uid, each.vertex_group, is_posed and each.is_free) for uid, each in found),
    )


def _state(obj: bpy.types.Object) -> str:
    """Digest of the vertices of ``obj``, of the weights of its groups, and of its mirrors."""
    keys = obj.data.shape_keys
    shape = coordinates(obj.data.vertices if keys is None else keys.reference_key.points)
    groups = {each.vertex_group for each in identified(obj).values()} & {*obj.vertex_groups.keys()}
    weights = group_weights(obj, groups)
    parts = [part for group in sorted(weights) for part in weights[group]]
    return _mirrors(obj) + digest(shape, *parts)


def _mirrors(obj: bpy.types.Object) -> str:
    """What the Mirror modifiers of ``obj`` are set to, and where their objects are against it."""
    found = []
    for each in symmetries(obj):
        away = None
        if each.mirror_object is not None:
            away = each.mirror_object.matrix_world.inverted_safe() @ obj.matrix_world
            away = np.round(np.array(away), 4).tolist()
        merged = each.merge_threshold if each.use_mirror_merge else 0.0
        found.append((each.name, tuple(each.use_axis), merged, away))
    return repr(found)
