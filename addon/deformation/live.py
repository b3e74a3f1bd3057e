"""A deformation that follows its handles while they are dragged."""

import bpy
import numpy as np
import spectral_tv

from ..scene.objects import Refusal, refusal
from .deform import Deformable, write

# A coarse answer this far from the optimum is drawn once more before the exact one is worked out,
# as that takes longer.
COARSE = 0.05
MOST_COARSE = 20


class LiveDeformation:
    """Keeps the shape key of one object up to date; `update` is called again and again."""

    def __init__(self, obj: bpy.types.Object) -> None:
        """Read ``obj``; raises Refusal or spectral_tv.MeshError if it cannot be deformed."""
        self._name = obj.name
        self._counts = _counts(obj)
        self._deformable = Deformable.read(obj)
        self._deformer = self._deformable.deformer(obj)
        self._targets: np.ndarray | None = None
        self._job: spectral_tv.Job | None = None
        self._coarse = 0
        self.is_settled = False

    def update(self) -> bool:
        """Follow the handles, or refine if they rest; tells whether the shape changed.

        Raises Refusal or spectral_tv.MeshError if the object can no longer be deformed.
        """
        obj = bpy.data.objects.get(self._name)
        reason = "it was removed or renamed" if obj is None else refusal(obj)
        if reason is not None:
            raise Refusal(reason)
        if _counts(obj) != self._counts:
            raise Refusal("its vertices or faces changed")
        targets = self._deformable.targets(obj)
        if self._targets is None or not np.array_equal(targets, self._targets):
            self._targets, self._coarse = targets, 0
            self.stop()
            return self._drag(obj)
        if self.is_settled:
            return False
        if self._coarse:
            return self._drag(obj)
        if self._job is None:
            self._job = self._deformer.start_solve(targets)
        if not self._job.done:
            return False
        write(obj, self._deformable.displacement(self._job.result()))
        self._job, self.is_settled = None, True
        return True

    def settle(self) -> None:
        """Work the exact answer out and wait for it."""
        while not self.is_settled:
            self.update()

    def stop(self) -> None:
        """Stop what runs in the background."""
        if self._job is not None:
            self._job.cancel()
        self._job, self.is_settled = None, False

    def _drag(self, obj: bpy.types.Object) -> bool:
        result = self._deformer.drag(self._targets)
        write(obj, self._deformable.displacement(result))
        is_coarse = result.gap > COARSE and self._coarse < MOST_COARSE
        self._coarse = self._coarse + 1 if is_coarse else 0
        return True


def _counts(obj: bpy.types.Object) -> tuple[int, int]:
    return len(obj.data.vertices), len(obj.data.loops)
