"""Making Blender's FBX exporter write animation curves only for what moves."""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

import numpy as np

from ..scene.temporary import Temporary

# Up to this, relative to the largest of them, values differ by rounding.
ROUNDING = 5e-7


@contextmanager
def moving_alone() -> Iterator[None]:
    """Have the exporter write no keyframes for objects, cameras and shape keys that stand still.

    Without simplification the exporter gives some keyframes to all of them. With simplification
    single axes that stand still get none, and Blender 5 ignores motion that has none along X.
    """
    channel = import_module("io_scene_fbx.fbx_utils").AnimationCurveNodeWrapper
    former = channel.simplify

    def simplify(self: Any, factor: float, step: float, force_keep: bool = False) -> None:
        former(self, factor, step, force_keep)
        values = self._frame_values_array
        # Takes of single actions may hold a pose.
        if values is None or force_keep or not values.size:
            return
        if (np.ptp(values, axis=1) <= ROUNDING * np.abs(values).max(axis=1)).all():
            self._frame_write_mask_array[:] = False

    with Temporary() as now:
        now.put(channel, "simplify", simplify)
        yield
