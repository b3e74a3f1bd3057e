"""A Multiresolution sculpt: its top level taken, decomposed and written back by buttons."""

from __future__ import annotations

import bpy
import numpy as np
from pictures import away, new_monkey
from screen import Steps, click, drag, find, key, picture, until

LEVELS = 2


def sculpt() -> Steps[None]:
    """From the sculpt to its work object and back, and one step of undo for the way back."""
    obj = new_sculpt()
    yield from away()
    yield from picture("panel_sculpt")
    before = top_level(obj)
    yield from click(*(yield from find("spectral_tv.work_object(")))
    yield from until(lambda: active() != obj, "the work object")
    work = active()
    assert len(work.data.vertices) == len(before)
    yield from click(*(yield from find("spectral_tv.decompose(")))
    yield from until(lambda: work.data.shape_keys is not None, "the bands of the work object")
    yield from away()
    yield from picture("panel_work_object")
    yield from drag(*(yield from find('Band 3"].value')), 60)
    yield from away()
    assert work.data.shape_keys.key_blocks[3].value > 0.1
    # By name from here on, as undo makes other objects.
    names = obj.name, work.name
    shape = shown(work)
    yield from click(*(yield from find("spectral_tv.write_back(")))
    yield from until(lambda: active().name == names[0], "the sculpt to be shown again")
    yield from away()
    yield from picture("sculpt_written_back")
    size = np.linalg.norm(np.ptp(shape, axis=0))
    assert np.abs(top_level(active()) - shape).max() < 1e-5 * size
    assert np.abs(shape - before).max() > 1e-3 * size
    yield from key("ctrl+z")
    yield from until(lambda: active().name == names[1], "undo of Write Back")
    np.testing.assert_array_equal(top_level(bpy.data.objects[names[0]]), before)
    assert active().data.shape_keys.key_blocks[3].value > 0.1, "undid more than Write Back"
    yield from key("ctrl+shift+z")
    yield from until(lambda: active().name == names[0], "redo of Write Back")
    assert np.abs(top_level(active()) - shape).max() < 1e-5 * size


def new_sculpt() -> bpy.types.Object:
    """Suzanne with levels, shown at the lowest of them, in place of all meshes."""
    obj = new_monkey(subdivisions=1)
    modifier = obj.modifiers.new("Multires", "MULTIRES")
    for _ in range(LEVELS):
        bpy.ops.object.multires_subdivide(modifier="Multires", mode="CATMULL_CLARK")
    modifier.levels = 1
    bpy.ops.ed.undo_push(message="Sculpt")
    return obj


def active() -> bpy.types.Object:
    return bpy.context.view_layer.objects.active


def top_level(obj: bpy.types.Object) -> np.ndarray:
    """Where the vertices of the top level are, (V, 3)."""
    modifier = obj.modifiers["Multires"]
    level, modifier.levels = modifier.levels, modifier.total_levels
    found = shown(obj)
    modifier.levels = level
    return found


def shown(obj: bpy.types.Object) -> np.ndarray:
    """Where the vertices of an object are seen, (V, 3)."""
    is_hidden = obj.hide_get()
    obj.hide_set(False)
    bpy.context.view_layer.update()
    seen = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    flat = np.empty(3 * len(seen.vertices), dtype=np.float32)
    seen.vertices.foreach_get("co", flat)
    obj.hide_set(is_hidden)
    return flat.reshape(-1, 3)
