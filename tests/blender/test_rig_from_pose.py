"""Rig from Pose: an armature whose bones show the pose, a bone for each rigid piece."""

from __future__ import annotations

import math
import re
from importlib import import_module

import bpy
import numpy as np
import pytest
from ball import saved_and_loaded
from conftest import MODULE
from deform_scene import (
    constrain,
    dumbbell_object,
    empty,
    evaluated,
    group,
    handle,
    key_positions,
    members,
)
from mathutils import Euler, Vector

BONES = ["Bone 1", "Bone 2"]


def bent(offset=(1, 0, -0.5), **transforms) -> bpy.types.Object:
    """A dumbbell, placed as said, whose lower end is pinned and whose upper one is pulled."""
    obj = dumbbell_object("POSE")
    for name, value in transforms.items():
        setattr(obj, name, value)
    bpy.context.view_layer.update()
    constrain(obj, "Feet", "PIN")
    constrain(obj, "Head", "OBJECT", target=empty(obj.matrix_world @ Vector((0, 0, 2))))
    handle(obj).location += obj.matrix_world.to_3x3() @ Vector(offset)
    bpy.context.view_layer.update()
    return obj


def in_world(obj, points: np.ndarray) -> np.ndarray:
    matrix = np.array(obj.matrix_world, dtype=float)
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def deformed(obj) -> np.ndarray:
    """Where Deform takes the vertices, in the world, the only thing that is seen."""
    bpy.ops.spectral_tv.deform()
    return in_world(obj, evaluated(obj))


def rigged(obj) -> bpy.types.Object:
    assert bpy.ops.spectral_tv.rig_from_pose() == {"FINISHED"}
    return obj.modifiers[0].object


def unlikeness(obj, pose: np.ndarray) -> float:
    """How far what is seen is from a pose in the world at most, relative to its size."""
    apart = np.linalg.norm(in_world(obj, evaluated(obj)) - pose, axis=1)
    return float(apart.max() / np.linalg.norm(np.ptp(pose, axis=0)))


def weights_of(obj, names) -> np.ndarray:
    found = np.zeros((len(obj.data.vertices), len(names)))
    columns = {obj.vertex_groups[name].index: column for column, name in enumerate(names)}
    for vertex in obj.data.vertices:
        for each in vertex.groups:
            if each.group in columns:
                found[vertex.index, columns[each.group]] = each.weight
    return found


def test_an_armature_of_two_bones_shows_the_pose(capfd):
    obj = bent()
    pose = deformed(obj)
    key = obj.data.shape_keys.key_blocks["Deformation"]
    rig = rigged(obj)
    told = capfd.readouterr().out
    assert re.search(
        r"rig of 2 bones, 'Dumbbell Rig', which shows the pose to within 0\.\d\d%", told
    )
    assert "settled to within" in told
    assert key.mute and "muted, as it would be added: 'Deformation'" in told
    assert unlikeness(obj, pose) < 0.02
    # Within the pieces it is the pose, whose pieces are rigid but for its joints.
    basis = key_positions(obj, "Basis")
    shown = in_world(obj, evaluated(obj))
    ends = np.abs(basis[:, 2]) > 0.9
    size = np.linalg.norm(np.ptp(pose, axis=0))
    np.testing.assert_allclose(shown[ends], pose[ends], atol=5e-3 * size)
    root, arm = (rig.pose.bones[name] for name in BONES)
    assert root.parent is None and arm.parent == root and not arm.bone.use_connect
    assert rig.users_collection == obj.users_collection and rig.show_in_front
    turn = arm.matrix_basis.to_quaternion()
    assert 25 < math.degrees(turn.angle) < 60
    # The joint is in the neck, and the hinge is the axis X of its bone.
    np.testing.assert_allclose(arm.bone.head_local, 0, atol=0.1 * size)
    assert abs(turn.axis.x) > 0.999
    assert obj.parent == rig and bpy.context.object == obj


def test_at_rest_it_is_the_mesh(capfd):
    obj = bent()
    rest = in_world(obj, evaluated(obj))
    rig = rigged(obj)
    for bone in rig.pose.bones:
        bone.matrix_basis.identity()
        bone.location, bone.rotation_quaternion = (0, 0, 0), (1, 0, 0, 0)
    np.testing.assert_allclose(in_world(obj, evaluated(obj)), rest, atol=1e-5)
    assert "Warning" not in capfd.readouterr().out
    assert obj.data.shape_keys is None


def test_weights_sum_to_one_and_those_of_the_user_stay():
    obj = bent()
    group(obj, "Bone 1", range(5), 0.25)
    before = {each.name: members(obj, each.name) for each in obj.vertex_groups}
    active = obj.vertex_groups.active_index = 1
    rig = rigged(obj)
    names = rig.data.bones.keys()
    assert names == ["Bone 1.001", "Bone 2"]
    assert obj.vertex_groups.keys() == ["Feet", "Head", "Bone 1", *names]
    assert obj.vertex_groups.active_index == active
    weights = weights_of(obj, names)
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-6)
    is_in = weights > 0
    assert [len(members(obj, name)) for name in names] == is_in.sum(axis=0).tolist()
    assert (weights[is_in] > 1e-4).all() and (is_in.sum(axis=1) == 1).sum() > 500
    for name, found in before.items():
        np.testing.assert_array_equal(members(obj, name), found)


@pytest.mark.parametrize(
    "transforms",
    [
        {"location": (3, 4, 5), "rotation_euler": (0.3, 1, 2), "scale": (2, 2, 2)},
        {"rotation_euler": (0.3, 1, 2), "scale": (1, 0.5, 0.7)},
        {"location": (1, 0, 0), "rotation_euler": (0.3, 1, 2), "scale": (-1, 1, 1)},
        {"scale": (0.01, 0.01, 0.01), "rotation_mode": "QUATERNION"},
    ],
    ids=["scaled", "unevenly", "mirrored", "small"],
)
def test_objects_that_are_turned_and_scaled(transforms):
    obj = bent(**transforms)
    pose = deformed(obj)
    before = np.array(obj.matrix_world)
    rig = rigged(obj)
    assert unlikeness(obj, pose) < 0.03
    np.testing.assert_allclose(obj.matrix_world, before, atol=1e-5)
    np.testing.assert_allclose(rig.matrix_world.to_scale(), 1, atol=1e-6)
    moved = pose + np.array([1, 2, 3])
    rig.location += Vector((1, 2, 3))
    bpy.context.view_layer.update()
    assert unlikeness(obj, moved) < 0.03


@pytest.mark.parametrize("scale", [(2, 2, 2), (1, 2, 1)])
def test_the_armature_gets_the_parent_that_the_object_had(scale, capfd):
    obj = dumbbell_object("POSE")
    parent = empty((1, 2, 3))
    parent.scale, parent.rotation_euler = scale, Euler((0.4, 0.5, 0.6))
    obj.rotation_euler = (0.7, 0, 0)
    obj.parent = parent
    bpy.context.view_layer.update()
    before = np.array(obj.matrix_world)
    constrain(obj, "Feet", "PIN")
    constrain(obj, "Head", "OBJECT", target=empty(obj.matrix_world @ Vector((0, 0, 2))))
    handle(obj).location += Vector((1, 0, 0))
    bpy.context.view_layer.update()
    rig = rigged(obj)
    np.testing.assert_allclose(obj.matrix_world, before, atol=1e-5)
    if scale == (2, 2, 2):
        assert obj.parent == rig and rig.parent == parent
    else:
        assert obj.parent == parent and rig.parent is None
        assert "'Handle' is scaled unevenly. Move both together" in capfd.readouterr().out


def test_an_object_that_is_animated_keeps_its_parent(capfd):
    obj = bent()
    obj.keyframe_insert("location", frame=1)
    rigged(obj)
    assert obj.parent is None
    assert "its animation or its constraints move the object" in capfd.readouterr().out


def test_what_does_not_bend_is_refused_and_nothing_is_left():
    obj = bent(offset=(0, 0, 0))
    with pytest.raises(RuntimeError, match=r"nothing bends: .* Move a handle first"):
        bpy.ops.spectral_tv.rig_from_pose()
    assert obj.vertex_groups.keys() == ["Feet", "Head"] and not obj.modifiers
    assert obj.parent is None and obj.data.shape_keys is None
    assert not any(each.type == "ARMATURE" for each in bpy.data.objects)
    assert not [each for each in bpy.data.armatures if each.users]
    assert len(bpy.data.scenes) == 1


def test_it_poses_by_pose_whatever_the_algorithm_is():
    obj = bent()
    pose = deformed(obj)
    obj.spectral_tv.algorithm = "CONVEX"
    rigged(obj)
    assert unlikeness(obj, pose) < 0.02
    assert obj.spectral_tv.algorithm == "CONVEX"


def test_weak_bends_are_rigged_too():
    obj = bent(offset=(0.3, 0, 0))
    pose = deformed(obj)
    rig = rigged(obj)
    assert rig.data.bones.keys() == BONES
    assert unlikeness(obj, pose) < 0.01


def test_the_armature_of_before_is_replaced_if_it_is_untouched(capfd):
    obj = bent()
    rigged(obj)
    handle(obj).location.y += 0.7
    bpy.context.view_layer.update()
    obj.modifiers[0].show_viewport = False
    pose = deformed(obj)
    obj.modifiers[0].show_viewport = True
    capfd.readouterr()
    rig = rigged(obj)
    told = capfd.readouterr().out
    assert "the armature 'Dumbbell Rig' of before is replaced" in told
    assert "modifiers act on" not in told
    assert rig.name == "Dumbbell Rig" and rig.data.bones.keys() == BONES
    assert obj.vertex_groups.keys() == ["Feet", "Head", *BONES]
    assert [each.name for each in obj.modifiers] == ["Rig"]
    assert sum(each.type == "ARMATURE" for each in bpy.data.objects) == 1
    assert obj.parent == rig and rig.parent is None
    assert unlikeness(obj, pose) < 0.02


def touched_pose(obj, rig) -> None:
    rig.pose.bones["Bone 2"].rotation_quaternion.x += 0.1


def touched_weights(obj, rig) -> None:
    obj.vertex_groups["Bone 1"].add([3], 0.5, "REPLACE")


def touched_animation(obj, rig) -> None:
    rig.pose.bones["Bone 2"].keyframe_insert("rotation_quaternion", frame=1)


def touched_constraint(obj, rig) -> None:
    rig.pose.bones["Bone 2"].constraints.new("COPY_LOCATION")


def touched_child(obj, rig) -> None:
    empty().parent = rig


def touched_clothes(obj, rig) -> None:
    other = bpy.data.objects.new("Shirt", bpy.data.meshes.new("Shirt"))
    bpy.context.scene.collection.objects.link(other)
    other.modifiers.new("Armature", "ARMATURE").object = rig


def touched_name(obj, rig) -> None:
    rig.data.bones["Bone 2"].name = "Arm"


@pytest.mark.parametrize(
    "touch",
    [
        touched_pose,
        touched_weights,
        touched_animation,
        touched_constraint,
        touched_child,
        touched_clothes,
        touched_name,
    ],
)
def test_one_that_the_user_took_over_stays_switched_off(touch, capfd):
    obj = bent()
    pose = deformed(obj)
    first = rigged(obj)
    touch(obj, first)
    bpy.context.view_layer.update()
    capfd.readouterr()
    second = rigged(obj)
    assert first != second and first.name == "Dumbbell Rig"
    assert [each.object for each in obj.modifiers] == [second, first]
    assert [each.show_viewport for each in obj.modifiers] == [True, False]
    assert "'Dumbbell Rig' is kept, as it was changed or used since" in capfd.readouterr().out
    assert {*first.data.bones.keys()}.isdisjoint(second.data.bones.keys())
    assert {*first.data.bones.keys(), *second.data.bones.keys()} <= {*obj.vertex_groups.keys()}
    assert obj.parent == second and second.parent is None
    assert unlikeness(obj, pose) < 0.02
    # The second one is recognised too.
    third = rigged(obj)
    assert len(obj.modifiers) == 2 and obj.modifiers[0].object == third


def test_it_is_recognised_in_a_file(tmp_path):
    obj = bent()
    rigged(obj)
    loaded = saved_and_loaded(obj, tmp_path / "rig.blend")
    armature = import_module(f"{MODULE}.deformation.armature")
    (modifier,) = armature.former(loaded)
    assert armature._digest(loaded, modifier.object) == modifier.object.spectral_tv.rig


def test_it_acts_before_other_modifiers(capfd):
    """As the shape key does in whose place it is."""
    obj = bent()
    other = obj.modifiers.new("Simple", "SIMPLE_DEFORM")
    other.deform_method, other.angle = "TWIST", 0.5
    pose = deformed(obj)
    capfd.readouterr()
    rigged(obj)
    assert "modifiers act on what is deformed, 'Simple'" in capfd.readouterr().out
    assert [each.name for each in obj.modifiers] == ["Rig", "Simple"]
    assert unlikeness(obj, pose) < 0.03


def test_a_mirrored_half_has_no_bones_of_its_own():
    """An arm that sticks out of a body on both sides, of which one is modelled."""
    obj = dumbbell_object("POSE")
    obj.rotation_euler = (0, math.pi / 2, 0)
    obj.location = (1.5, 0, 0)
    bpy.ops.object.transform_apply()
    modifier = obj.modifiers.new("Mirror", "MIRROR")
    modifier.use_axis = (True, False, False)
    modifier.use_mirror_merge = False
    bpy.context.view_layer.update()
    basis = np.array([vertex.co for vertex in obj.data.vertices])
    low = obj.matrix_world @ Vector(basis[members(obj, "Head")].mean(axis=0))
    constrain(obj, "Feet", "PIN")
    constrain(obj, "Head", "OBJECT", target=empty(low))
    handle(obj).location.z += 1
    bpy.context.view_layer.update()
    pose = deformed(obj)
    rig = rigged(obj)
    assert rig.data.bones.keys() == BONES
    assert obj.modifiers[0].type == "ARMATURE"
    assert len(evaluated(obj)) == 2 * len(obj.data.vertices)
    assert unlikeness(obj, pose) < 0.03


def test_loose_parts_move_with_the_piece_that_they_are_in():
    """Such as eyes, which no constraint holds."""
    obj = bent(offset=(0, 0, 0))
    bpy.ops.mesh.primitive_ico_sphere_add(radius=0.1, location=(0, 0, 1.4))
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    bpy.ops.object.join()
    obj.vertex_groups["Head"].add(
        range(len(obj.data.vertices) - 42, len(obj.data.vertices)), 1, "ADD"
    )
    handle(obj).location += Vector((1, 0, -0.5))
    bpy.context.view_layer.update()
    rig = rigged(obj)
    weights = weights_of(obj, rig.data.bones.keys())
    assert weights.shape[1] == 2
    head = members(obj, "Head")
    assert (weights[head] == weights[head[0]]).all()


def test_linked_objects_are_refused(tmp_path):
    obj = bent()
    path = tmp_path / "linked.blend"
    bpy.data.libraries.write(str(path), {obj})
    with bpy.data.libraries.load(str(path), link=True) as (_, target):
        target.objects = [obj.name]
    linked = target.objects[0]
    bpy.context.scene.collection.objects.link(linked)
    bpy.context.view_layer.objects.active = linked
    assert not bpy.ops.spectral_tv.rig_from_pose.poll()
    bpy.context.scene.collection.objects.unlink(linked)


def test_an_object_that_is_hidden_or_sculpted_is_rigged_where_it_is():
    obj = bent()
    other = bpy.data.collections.new("Other")
    bpy.context.scene.collection.children.link(other)
    other.objects.link(obj)
    bpy.context.scene.collection.objects.unlink(obj)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.mode_set(mode="SCULPT")
    rig = rigged(obj)
    assert obj.mode == "SCULPT" and rig.mode == "OBJECT"
    assert rig.users_collection == (other,)
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.data.collections.remove(other)
