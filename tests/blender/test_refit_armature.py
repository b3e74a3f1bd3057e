"""bpy.ops.spectral_tv.refit_armature: bones go along with the look of a body."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from ball import ball
from deform_scene import group
from mathutils import Matrix

OPS = bpy.ops.spectral_tv


def joints(rig: bpy.types.Object) -> np.ndarray:
    """Heads and tails of the bones in the world, (B, 2, 3)."""
    return np.array(
        [[rig.matrix_world @ each for each in (b.head_local, b.tail_local)] for b in rig.data.bones]
    )


@pytest.fixture
def rigged():
    """A ball with bands, and two connected bones from pole to pole; the ball is active."""
    bpy.ops.object.armature_add(enter_editmode=True)
    rig = bpy.context.object
    first = rig.data.edit_bones[0]
    first.head, first.tail = (0.0, 0.0, -0.745), (0.0, 0.0, 0.0)
    second = rig.data.edit_bones.new("Upper")
    second.head, second.tail = (0.0, 0.0, 0.0), (0.0, 0.0, 0.745)
    second.parent, second.use_connect = first, True
    bpy.ops.object.mode_set(mode="OBJECT")
    rig.matrix_world = Matrix.Translation((5, 0, 0)) @ Matrix.Scale(2, 4)
    obj = ball("Ball", 3)
    obj.matrix_world = Matrix.Translation((5, 0, 0))
    rig.select_set(True)
    OPS.decompose(bands=2, steps=8, keep_limbs=0)
    key = obj.data.shape_keys.key_blocks[2]
    return obj, rig, key


def test_joints_go_along_and_back(rigged):
    obj, rig, key = rigged
    before = joints(rig)
    poles = [max(obj.data.vertices, key=lambda v, up=up: up * v.co.z).index for up in (-1, 1)]
    basis = obj.data.shape_keys.key_blocks[0]
    key.value = 1
    for _ in range(2):
        assert OPS.refit_armature() == {"FINISHED"}
        steps = joints(rig) - before
        wanted = [key.data[pole].co - basis.data[pole].co for pole in poles]
        length = np.linalg.norm(wanted[0])
        assert length > 0.002
        np.testing.assert_allclose(steps[[0, 1], [0, 1]], wanted, atol=0.2 * length)
        np.testing.assert_allclose(steps[0, 1], 0, atol=0.1 * length)
        np.testing.assert_allclose(joints(rig)[0, 1], joints(rig)[1, 0], atol=1e-6)
    assert rig.data.bones["Upper"].use_connect
    assert bpy.context.object.name == "Ball"
    key.value = 0
    OPS.refit_armature()
    np.testing.assert_allclose(joints(rig), before, atol=1e-6)


def test_without_an_armature_it_is_refused(rigged):
    _, rig, _ = rigged
    rig.select_set(False)
    with pytest.raises(RuntimeError, match="select the one armature"):
        OPS.refit_armature()


def test_mirrored_bones_do_not_drag_each_other_along(rigged):
    """As Edit Mode has them do if X-Axis Mirror is on, for which the body is not alike enough."""
    obj, rig, key = rigged
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for side, x in (("L", 0.4), ("R", -0.4)):
        bone = rig.data.edit_bones.new(f"Arm.{side}")
        bone.head, bone.tail = (x / 2, 0, 0), (x, 0, 0)
    bpy.ops.object.mode_set(mode="POSE")
    bpy.context.view_layer.objects.active = obj
    before = joints(rig)
    group(obj, "Left", [vertex.index for vertex in obj.data.vertices if vertex.co.x > 0])
    key.value, key.vertex_group = 1, "Left"
    rig.data.use_mirror_x = True
    assert OPS.refit_armature() == {"FINISHED"}
    assert rig.mode == "POSE" and rig.data.use_mirror_x
    left, right = np.linalg.norm(joints(rig) - before, axis=2)[2:, 1]
    assert left > 5e-5 and right < 0.3 * left
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="OBJECT")


def test_what_hangs_on_bones_stays_and_what_follows_them_is_told(rigged, capfd):
    _, rig, key = rigged
    eye, hat = (bpy.data.objects.new(name, None) for name in ("Eye", "Hat"))
    for each in (eye, hat):
        bpy.context.scene.collection.objects.link(each)
    eye.parent, eye.parent_type, eye.parent_bone = rig, "BONE", "Upper"
    constraint = hat.constraints.new("CHILD_OF")
    constraint.target, constraint.subtarget = rig, "Upper"
    bpy.context.view_layer.update()
    before = np.array(eye.matrix_world)
    key.value = 1
    assert OPS.refit_armature() == {"FINISHED"}
    bpy.context.view_layer.update()
    np.testing.assert_allclose(np.array(eye.matrix_world), before, rtol=0, atol=2e-6)
    told = capfd.readouterr().out
    assert "stays where it is at rest: Eye" in told
    assert "follow its bones to where they are now: Hat" in told
