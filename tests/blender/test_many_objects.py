"""A long session: many objects one after another, and memory that levels off."""

from __future__ import annotations

import ctypes
import sys
from pathlib import Path

import bpy
import pytest
from ball import ball

pytestmark = pytest.mark.once

COUNT = 200
BANDS, STEPS = 3, 64  # flows much larger than what else a decomposition leaves


def kilobytes() -> float:
    """Memory of this process, without what was freed and not given back to the system."""
    ctypes.CDLL(None).malloc_trim(0)
    status = Path("/proc/self/status").read_text(encoding="utf-8")
    return int(status.split("VmRSS:")[1].split()[0])


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_of_two_hundred_objects_only_the_shape_keys_are_kept():
    """Those removed, memory stays where it was once the last few flows were in it."""
    for number in range(COUNT):
        obj = ball(f"Ball {number}", detail=3)
        obj.scale.x = 1 + number / COUNT  # no flow is that of another object
    bpy.context.view_layer.update()
    used = []
    for number in range(COUNT):
        obj = bpy.data.objects[f"Ball {number}"]
        bpy.context.view_layer.objects.active = obj
        assert bpy.ops.spectral_tv.decompose(bands=BANDS, steps=STEPS) == {"FINISHED"}
        assert len(obj.data.shape_keys.key_blocks) == BANDS + 1
        obj.shape_key_clear()
        used.append(kilobytes())
    settled = COUNT // 4
    flow = STEPS * len(obj.data.vertices) * 3 * 4 / 1024
    # The least of some, as what was freed goes back to the system now and then.
    before, after = min(used[settled : 2 * settled]), min(used[-settled:])
    assert after - before < flow * (COUNT - 2 * settled) / 3, used
