"""bpy.ops.spectral_tv.deform on real objects, with constraints of every kind."""

from __future__ import annotations

import math

import bmesh
import bpy
import numpy as np
import pytest
from deform_scene import (
    armature,
    constrain,
    coordinates,
    empty,
    evaluated,
    handle,
    key_positions,
    members,
)
from mathutils import Euler, Matrix, Vector


def test_the_handle_takes_its_ball_along_and_the_neck_gives(held):
    before = coordinates(held.data.vertices)
    handle(held).location += Vector((0.6, 0, 0.3))
    bpy.context.view_layer.update()
    assert bpy.ops.spectral_tv.deform(softness=0) == {"FINISHED"}
    keys = held.data.shape_keys.key_blocks
    assert [key.name for key in keys] == ["Basis", "Deformation"]
    assert keys["Deformation"].value == 1 and keys["Deformation"].relative_key == keys["Basis"]
    np.testing.assert_array_equal(key_positions(held, "Basis"), before)
    np.testing.assert_allclose(evaluated(held), key_positions(held), atol=1e-6)

    moved = key_positions(held) - before
    head, feet = members(held, "Head"), members(held, "Feet")
    np.testing.assert_allclose(moved[head], np.tile([0.6, 0, 0.3], (len(head), 1)), atol=1e-6)
    np.testing.assert_allclose(moved[feet], 0, atol=1e-6)
    # Both balls are rigid but for the surroundings of the neck.
    upper, lower = before[:, 2] > 0.8, before[:, 2] < -0.8
    np.testing.assert_allclose(
        moved[upper], np.tile([0.6, 0, 0.3], (np.count_nonzero(upper), 1)), atol=0.01
    )
    np.testing.assert_allclose(moved[lower], 0, atol=0.01)


def test_softness_widens_the_stretched_zone(held):
    handle(held).location.x += 0.5
    bpy.context.view_layer.update()
    before = coordinates(held.data.vertices)
    stretched = []
    for softness in (10, 40, 80):
        bpy.ops.spectral_tv.deform(softness=softness)
        moved = (key_positions(held) - before)[:, 0]
        between = (moved > 0.02) & (moved < 0.48)
        stretched.append(np.ptp(before[between, 2]))
    assert stretched[0] < stretched[1] < stretched[2]


def test_the_objects_own_settings_hold_where_none_are_given(held):
    handle(held).location.x += 0.5
    bpy.context.view_layer.update()
    held.spectral_tv.algorithm = "HARMONIC"
    bpy.ops.spectral_tv.deform()
    harmonic = key_positions(held)
    held.spectral_tv.algorithm = "CONVEX"
    bpy.ops.spectral_tv.deform(algorithm="HARMONIC")
    np.testing.assert_array_equal(key_positions(held), harmonic)


@pytest.mark.parametrize("algorithm", ["CONVEX", "PAPER", "HARMONIC", "BIHARMONIC", "ARAP"])
def test_a_turned_and_scaled_handle_moves_its_group_as_one(held, algorithm):
    pivot = handle(held)
    start = np.array(pivot.matrix_world)
    pivot.rotation_euler = Euler((0.3, 0.5, -0.4))
    pivot.scale = (1.2, 1.2, 1.2)
    pivot.location.y += 0.4
    bpy.context.view_layer.update()
    bpy.ops.spectral_tv.deform(algorithm=algorithm)
    motion = np.array(pivot.matrix_world) @ np.linalg.inv(start)
    head = members(held, "Head")
    expected = key_positions(held, "Basis")[head] @ motion[:3, :3].T + motion[:3, 3]
    np.testing.assert_allclose(key_positions(held)[head], expected, atol=1e-5)


def test_the_objects_own_transform_is_seen_through(held):
    """Handles move in the world, wherever the object is, turned and stretched."""
    held.matrix_world = (
        Matrix.Translation((3, -2, 5))
        @ Euler((0.4, 1.0, -0.7)).to_matrix().to_4x4()
        @ Matrix.Diagonal((2, 0.5, 1.5, 1))
    )
    pivot = handle(held)
    bpy.context.view_layer.update()
    held.spectral_tv.constraints[1].target = pivot  # rest is where both are now
    pivot.location += Vector((0.5, 0.2, -0.3))
    bpy.context.view_layer.update()
    bpy.ops.spectral_tv.deform()
    head, feet = members(held, "Head"), members(held, "Feet")
    to_world = np.array(held.matrix_world)[:3, :3]
    moved = (key_positions(held) - key_positions(held, "Basis")) @ to_world.T
    np.testing.assert_allclose(moved[head], np.tile([0.5, 0.2, -0.3], (len(head), 1)), atol=1e-5)
    np.testing.assert_allclose(moved[feet], 0, atol=1e-5)


def test_a_bone_is_followed(body):
    rig, pose = armature()
    constrain(body, "Feet", "PIN")
    constrain(body, "Head", "OBJECT", target=rig, bone="Neck")
    pose.rotation_mode = "XYZ"
    pose.rotation_euler.x = math.radians(25)
    bpy.context.view_layer.update()
    bpy.ops.spectral_tv.deform()
    motion = np.array(pose.matrix) @ np.linalg.inv(np.array(pose.bone.matrix_local))
    head = members(body, "Head")
    expected = key_positions(body, "Basis")[head] @ motion[:3, :3].T + motion[:3, 3]
    np.testing.assert_allclose(key_positions(body)[head], expected, atol=1e-5)


def test_a_shape_key_gives_the_targets(body):
    body.shape_key_add(name="Basis")
    target = body.shape_key_add(name="Smile")
    shape = key_positions(body, "Basis")
    shape[:, 1] += 0.4 * np.sin(shape[:, 0])
    target.data.foreach_set("co", shape.astype(np.float32).ravel())
    constrain(body, "Feet", "PIN")
    constrain(body, "Head", "KEY", shape_key="Smile")
    bpy.ops.spectral_tv.deform()
    head = members(body, "Head")
    np.testing.assert_allclose(key_positions(body)[head], shape[head], atol=1e-6)
    np.testing.assert_allclose(key_positions(body, "Smile"), shape, atol=1e-6)


def test_weights_below_one_are_springs(body):
    constrain(body, "Feet", "PIN")
    body.vertex_groups["Head"].add([int(i) for i in members(body, "Head")], 0.3, "REPLACE")
    constrain(body, "Head", "OBJECT", target=empty((0, 0, 2)))
    handle(body).location.x += 1
    bpy.context.view_layer.update()
    bpy.ops.spectral_tv.deform()
    moved = (key_positions(body) - key_positions(body, "Basis"))[members(body, "Head"), 0]
    assert 0.3 < moved.mean() < 0.99


def test_deforming_again_overwrites_its_key_alone(held):
    bpy.ops.spectral_tv.decompose(bands=3, steps=8)
    bands = [key_positions(held, f"Shape Detail Band {band}") for band in (1, 2, 3)]
    handle(held).location.x += 0.5
    bpy.context.view_layer.update()
    bpy.ops.spectral_tv.deform()
    first = key_positions(held)
    held.data.shape_keys.key_blocks["Deformation"].value = 0.5
    held.data.shape_keys.key_blocks["Deformation"].name = "Lean"
    handle(held).location.x += 0.5
    bpy.context.view_layer.update()
    bpy.ops.spectral_tv.deform()
    names = [key.name for key in held.data.shape_keys.key_blocks]
    assert names == [
        "Basis",
        "Shape Detail Band 1",
        "Shape Detail Band 2",
        "Shape Detail Band 3",
        "Lean",
    ]
    assert held.data.shape_keys.key_blocks["Lean"].value == 0.5
    assert np.abs(key_positions(held, "Lean") - first).max() > 0.4
    for band, before in enumerate(bands, start=1):
        np.testing.assert_array_equal(key_positions(held, f"Shape Detail Band {band}"), before)
    bpy.ops.spectral_tv.cut(bands=2)
    assert "Lean" in held.data.shape_keys.key_blocks


def test_the_gap_and_parts_that_came_along_are_reported(held, capfd):
    eye = bpy.data.meshes.new("Eye")
    eye.from_pydata([(1.1, 0, 1.4), (1.2, 0, 1.4), (1.1, 0.1, 1.4)], [], [(0, 1, 2)])
    part = bpy.data.objects.new("Eye", eye)
    bpy.context.scene.collection.objects.link(part)
    part.select_set(True)
    bpy.ops.object.join()
    handle(held).location.x += 0.5
    bpy.context.view_layer.update()
    bpy.ops.spectral_tv.deform(softness=0)
    told = capfd.readouterr().out
    assert "% of the optimum" in told and "3 vertices of parts without a constraint" in told
    moved = key_positions(held) - key_positions(held, "Basis")
    np.testing.assert_allclose(moved[-3:], np.tile([0.5, 0, 0], (3, 1)), atol=0.01)


def spoil_group(obj):
    obj.spectral_tv.constraints[1].vertex_group = "Tail"


def spoil_members(obj):
    obj.vertex_groups["Head"].remove([int(index) for index in members(obj, "Head")])


def spoil_object(obj):
    bpy.data.objects.remove(handle(obj))


def spoil_overlap(obj):
    obj.vertex_groups["Feet"].add([int(index) for index in members(obj, "Head")], 1.0, "ADD")
    handle(obj).location.x += 1


def spoil_all(obj):
    obj.vertex_groups["Feet"].add(list(range(len(obj.data.vertices))), 1.0, "ADD")
    obj.spectral_tv.constraints.remove(1)


def spoil_key(obj):
    obj.spectral_tv.constraints[1].kind = "KEY"
    obj.spectral_tv.constraints[1].shape_key = "Smile"


def spoil_place(obj):
    handle(obj).location.x = math.nan


@pytest.mark.parametrize(
    ("spoil", "told"),
    [
        (spoil_group, "there is no vertex group 'Tail'"),
        (spoil_members, "the vertex group 'Head' is empty"),
        (spoil_object, "the object that moves 'Head' is missing"),
        (spoil_overlap, "are in both 'Feet' and 'Head', which go to different places"),
        (spoil_all, "nothing is left to deform"),
        (spoil_key, "there is no shape key 'Smile' to move to"),
        (spoil_place, "not finite"),
    ],
)
def test_what_cannot_be_done_is_told_and_nothing_is_lost(held, spoil, told):
    spoil(held)
    bpy.context.view_layer.update()
    before = coordinates(held.data.vertices)
    with pytest.raises(RuntimeError, match=told):
        bpy.ops.spectral_tv.deform()
    np.testing.assert_array_equal(coordinates(held.data.vertices), before)
    assert held.data.shape_keys is None


def test_without_constraints_the_operator_says_what_is_missing(body):
    with pytest.raises(
        RuntimeError, match="press Hold & Pull, then click what stays and what moves"
    ):
        bpy.ops.spectral_tv.deform()


def test_constraints_are_made_of_a_selection(body):
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    body.vertex_groups.active_index = 0
    assert bpy.ops.spectral_tv.constraint_add(kind="OBJECT") == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    (constraint,) = body.spectral_tv.constraints
    assert len(members(body, constraint.vertex_group)) == len(body.data.vertices)
    assert constraint.target.type == "EMPTY"
    np.testing.assert_allclose(constraint.target.location, (0, 0, 0), atol=1e-5)

    body.vertex_groups.active_index = body.vertex_groups["Head"].index
    bpy.ops.spectral_tv.constraint_add(kind="PIN")
    assert body.spectral_tv.constraints[1].vertex_group == "Head"
    assert body.spectral_tv.active == 1
    bpy.ops.spectral_tv.constraint_remove()
    assert [each.kind for each in body.spectral_tv.constraints] == ["OBJECT"]


def test_rest_is_where_the_handle_is_when_it_is_set(held):
    handle(held).location.x += 1
    bpy.context.view_layer.update()
    held.spectral_tv.active = 1
    bpy.ops.spectral_tv.constraint_rest()
    bpy.ops.spectral_tv.deform()
    np.testing.assert_allclose(key_positions(held), key_positions(held, "Basis"), atol=1e-6)


def test_constraints_are_kept_in_the_file(held, tmp_path):
    handle(held).location.x += 0.5
    bpy.context.view_layer.update()
    path = str(tmp_path / "held.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False)
    bpy.ops.wm.open_mainfile(filepath=path)
    obj = bpy.data.objects["Dumbbell"]
    bpy.context.view_layer.objects.active = obj
    bpy.ops.spectral_tv.deform()
    head = members(obj, "Head")
    moved = (key_positions(obj) - key_positions(obj, "Basis"))[head]
    np.testing.assert_allclose(moved, np.tile([0.5, 0, 0], (len(head), 1)), atol=1e-6)


@pytest.mark.parametrize("kind", ["PIN", "OBJECT"])
def test_a_constraint_of_a_selection_is_exact_whatever_the_tools_are_set_to(body, kind):
    settings = bpy.context.scene.tool_settings
    settings.vertex_group_weight = 0.3
    settings.use_auto_normalize = settings.use_multipaint = True
    body.vertex_groups["Feet"].lock_weight = True
    body.data.use_mirror_vertex_groups = body.data.use_mirror_x = True
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    edited = bmesh.from_edit_mesh(body.data)
    edited.verts.ensure_lookup_table()
    chosen = [int(index) for index in members(body, "Head")[:40]]
    for index in chosen:
        edited.verts[index].select_set(True)
    bpy.ops.spectral_tv.constraint_add(kind=kind)
    assert settings.vertex_group_weight == pytest.approx(0.3)
    bpy.ops.object.mode_set(mode="OBJECT")
    name = {"PIN": "Pin", "OBJECT": "Handle"}[kind]
    (constraint,) = body.spectral_tv.constraints
    assert constraint.vertex_group == name == body.vertex_groups.active.name
    index = body.vertex_groups[name].index
    weights = {
        vertex.index: each.weight
        for vertex in body.data.vertices
        for each in vertex.groups
        if each.group == index
    }
    assert weights == dict.fromkeys(chosen, 1.0)
    settings.vertex_group_weight = 1
    settings.use_auto_normalize = settings.use_multipaint = False


def test_a_pin_that_gives_way_is_told(held, capfd):
    feet = [int(index) for index in members(held, "Feet")]
    held.vertex_groups["Feet"].add(feet, 0.3, "REPLACE")
    bpy.ops.spectral_tv.deform()
    told = capfd.readouterr().out
    assert "no vertex of the pin 'Feet' has the weight 1, it gives way: the largest is 0.3" in told
    held.vertex_groups.active_index = held.vertex_groups["Feet"].index
    bpy.ops.spectral_tv.constraint_add(kind="PIN")
    assert "no vertex of 'Feet' has the weight 1" in capfd.readouterr().out
    held.vertex_groups["Feet"].add(feet[:3], 1, "REPLACE")  # painted to fade out
    bpy.ops.spectral_tv.deform()
    assert "gives way" not in capfd.readouterr().out
