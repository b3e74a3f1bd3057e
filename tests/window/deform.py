"""Deforming by hand: constraints, a handle that is dragged, undo."""

from __future__ import annotations

import sys
from pathlib import Path

import bpy
import numpy as np
from pictures import NEXT_HEADER, activate, away
from screen import Steps, click, find, key, picture, until, xdotool

sys.path.insert(0, str(Path(__file__).parents[1]))

from shapes import dumbbell


def deform() -> Steps[None]:
    obj = new_dumbbell()
    x, y = yield from find("spectral_tv.shown_largest", column=0.7)
    yield from click(x - 100, y - NEXT_HEADER)
    yield from constrain(obj)
    yield from away()
    yield from picture("panel_deform")
    yield from drag_live(obj)
    yield from deform_once(obj)


def constrain(obj: bpy.types.Object) -> Steps[None]:
    """A pin and a handle, by their buttons, for the active vertex group."""
    for group, kind in (("Feet", "PIN"), ("Head", "OBJECT")):
        obj.vertex_groups.active = obj.vertex_groups[group]
        yield from click(*(yield from find(f"constraint_add(kind='{kind}')", column=0.83)))
        count = len(obj.spectral_tv.constraints)
        assert obj.spectral_tv.constraints[count - 1].vertex_group == group
    assert [each.kind for each in obj.spectral_tv.constraints] == ["PIN", "OBJECT"]


def drag_live(obj: bpy.types.Object) -> Steps[None]:
    """The mesh follows while the handle is under the mouse, and settles when it rests."""
    yield from click(*(yield from find("spectral_tv.deform_live", column=0.75)))
    yield from until(lambda: leaning(obj) is not None, "the live deformation to start")
    handle = obj.spectral_tv.constraints[1].target
    activate(handle)
    obj.select_set(False)
    handle.select_set(True)
    yield from away()
    yield from key("g")
    yield from key("x")
    seen = set()
    for _ in range(12):
        xdotool("mousemove_relative", "--", 12, 0)
        yield 0.1
        seen.add(round(leaning(obj), 4))
    assert len(seen) > 6, f"the mesh did not follow: {sorted(seen)}"
    yield from picture("live_dragged")
    xdotool("click", 1)
    yield 0.5
    offset = handle.matrix_world.translation.x
    assert abs(offset) > 0.05
    yield from until(lambda: abs(leaning(obj) - offset) < 1e-4, "the mesh to arrive")
    yield from click(*(yield from find("spectral_tv.deform_live")))  # the handle is still active
    activate(obj)
    yield from away()
    handle.location.x = 0
    yield 0.5
    assert abs(leaning(obj) - offset) < 1e-4
    yield from picture("live_ended")


def deform_once(obj: bpy.types.Object) -> Steps[None]:
    """The button works the exact answer out; one undo takes it back."""
    before = leaning(obj)
    handle = obj.spectral_tv.constraints[1].target
    handle.location.x = before + 0.4
    bpy.ops.ed.undo_push(message="Move the handle")
    yield from click(*(yield from find("spectral_tv.deform(", column=0.3)))
    yield from until(lambda: abs(leaning(obj) - before - 0.4) < 1e-4, "the deformation")
    yield from picture("deformed")
    yield from away()
    yield from key("ctrl+z")
    name = "Dumbbell"
    yield from until(
        lambda: abs(leaning(bpy.data.objects[name]) - before) < 1e-4, "undo of the deformation"
    )


def new_dumbbell() -> bpy.types.Object:
    """A dumbbell with vertex groups at its ends, in place of all meshes."""
    for obj in [obj for obj in bpy.data.objects if obj.type == "MESH"]:
        bpy.data.objects.remove(obj)
    vertices, faces = dumbbell(n_around=64, n_along=160)
    mesh = bpy.data.meshes.new("Dumbbell")
    mesh.from_pydata(vertices.tolist(), [], faces.tolist())
    obj = bpy.data.objects.new("Dumbbell", mesh)
    bpy.context.collection.objects.link(obj)
    for name, chosen in (("Feet", vertices[:, 2] < -0.9), ("Head", vertices[:, 2] > 1.8)):
        members = [int(index) for index in np.flatnonzero(chosen)]
        obj.vertex_groups.new(name=name).add(members, 1.0, "REPLACE")
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    bpy.context.scene.spectral_tv.method = "M1"
    return obj


def leaning(obj: bpy.types.Object) -> float | None:
    """How far the top has moved along X; None without a deformation."""
    keys = obj.data.shape_keys
    if keys is None or "Deformation" not in keys.key_blocks:
        return None
    top = obj.data.vertices[0].index
    basis, shape = keys.key_blocks[0].data, keys.key_blocks["Deformation"].data
    return shape[top].co.x - basis[top].co.x
