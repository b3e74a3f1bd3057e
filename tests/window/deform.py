"""Deforming by hand: constraints, a handle that is dragged, undo."""

from __future__ import annotations

import sys
from pathlib import Path

import bpy
import numpy as np
from pictures import NEXT_HEADER, activate, away
from screen import Steps, click, find, in_view, key, picture, told, until, xdotool

sys.path.insert(0, str(Path(__file__).parents[1]))

from shapes import dumbbell

MODULE = "bl_ext.user_default.spectral_tv"


def deform() -> Steps[None]:
    obj = new_dumbbell()
    x, y = yield from find("spectral_tv.length_largest", column=0.7)
    yield from click(x - 100, y - NEXT_HEADER)
    yield from constrain(obj)
    yield from away()
    yield from picture("panel_deform")
    yield from drag_live(obj)
    yield from deform_once(obj)
    yield from change_while_live()
    yield from take_what_turns()


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


def change_while_live() -> Steps[None]:
    """What is changed acts at once; while something is wrong, it waits and the panel says why."""
    obj = held_dumbbell()
    handle = obj.spectral_tv.constraints[1].target
    yield from away()
    yield from click(*(yield from find("spectral_tv.deform_live", column=0.75)))
    handle.location.x += 0.3
    yield from until(lambda: leaning(obj) is not None, "the live deformation to follow")
    yield from until(lambda: abs(leaning(obj) - 0.3) < 1e-4, "the mesh to arrive")
    assert abs(leaning(obj, "Feet")) < 1e-4
    handle.hide_viewport = True
    yield from until(lambda: running().problem != "", "it to notice the hidden handle")
    yield from away()
    yield from picture("live_waits")
    assert "waiting: Blender does not move what is hidden" in (yield from told())
    handle.hide_viewport = False
    yield from until(lambda: running().problem == "", "it to go on")
    obj.spectral_tv.active = 0
    yield from away()
    yield from click(*(yield from find("spectral_tv.constraint_remove", column=0.83)))
    assert [each.kind for each in obj.spectral_tv.constraints] == ["OBJECT"]
    obj.spectral_tv.algorithm = "CONVEX"  # nothing holds the other end still
    yield from until(lambda: abs(leaning(obj, "Feet") - 0.3) < 1e-4, "all to follow the handle")
    obj.spectral_tv.algorithm = "ARAP"
    yield from until(lambda: running() is None, "another algorithm to end it")
    assert "no longer live: Live and Bake Animation need" in (yield from told())


def take_what_turns() -> Steps[None]:
    """The panel says that pieces do not turn, and buttons take what turns them."""
    obj = held_dumbbell()
    obj.spectral_tv.algorithm = "CONVEX"
    obj.spectral_tv.constraints[1].target.rotation_euler.y = 1
    yield from away()
    yield from picture("panel_turning")
    yield from click(*(yield from find("spectral_tv.algorithm", column=0.2)))
    assert obj.spectral_tv.algorithm == "POSE"
    yield from away()
    yield from picture("panel_free_to_turn")
    yield from click(*(yield from find("].turns", column=0.7)))
    assert obj.spectral_tv.constraints[1].turns
    yield from away()
    yield from picture("panel_turned")
    yield from click(*(yield from find("spectral_tv.deform(", column=0.3)))
    yield from until(lambda: leaning(obj) is not None, "the deformation")
    assert "turned" not in (yield from told()).splitlines()[-1]
    obj.shape_key_clear()  # what panels say of it takes room


def running() -> bpy.types.Operator | None:
    return sys.modules[f"{MODULE}.deformation.live_operator"].SPECTRAL_TV_OT_deform_live.running


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


def held_dumbbell() -> bpy.types.Object:
    """The same, one end pinned and the other one with a handle."""
    obj = new_dumbbell()
    for group, kind in (("Feet", "PIN"), ("Head", "OBJECT")):
        obj.vertex_groups.active = obj.vertex_groups[group]
        with in_view():
            bpy.ops.spectral_tv.constraint_add(kind=kind)
    return obj


def leaning(obj: bpy.types.Object, group: str = "Head") -> float | None:
    """How far the middle of a group has moved along X; None without a deformation."""
    keys = obj.data.shape_keys
    if keys is None or "Deformation" not in keys.key_blocks:
        return None
    basis, shape = (
        np.array([point.co.x for point in keys.key_blocks[name].data])
        for name in (keys.reference_key.name, "Deformation")
    )
    index = obj.vertex_groups[group].index
    is_in = [any(each.group == index for each in v.groups) for v in obj.data.vertices]
    return float((shape - basis)[is_in].mean())
