"""Baking: every frame has its shape, however it is played; a failure leaves nothing behind."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import bpy
import numpy as np
import pytest
from conftest import MODULE
from contents import contents
from deform_scene import (
    constrain,
    dumbbell_object,
    empty,
    evaluated,
    handle,
    key_positions,
    members,
)


@pytest.fixture(autouse=True)
def _as_it_was():
    yield
    scene = bpy.context.scene
    if scene.rigidbody_world is not None:
        bpy.ops.rigidbody.world_remove()
    scene.render.frame_map_old = scene.render.frame_map_new = 100
    bpy.data.batch_remove([*bpy.data.actions, *bpy.data.collections, *bpy.data.libraries])
    scene.frame_set(1)


def bake(start: int = 1, end: int = 9, step: int = 4) -> None:
    result = bpy.ops.spectral_tv.bake_deformation(frame_start=start, frame_end=end, step=step)
    assert result == {"FINISHED"}


def names(obj) -> list[str]:
    return [key.name for key in obj.data.shape_keys.key_blocks]


def seen(obj) -> np.ndarray:
    """How far along X the head is seen from its rest."""
    head = members(obj, "Head")
    return evaluated(obj)[head, 0] - key_positions(obj, "Basis")[head, 0]


def assert_follows(obj, frames) -> None:
    """On each frame the head is seen where the handle is."""
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        assert seen(obj).max() - seen(obj).min() < 1e-5
        np.testing.assert_allclose(
            seen(obj).mean(), handle(obj).matrix_world.translation.x, atol=1e-5
        )


def drive(obj) -> None:
    """Have the handle go evenly along X."""
    handle(obj).driver_add("location", 0).driver.expression = "(frame - 1) / 10"


def key_the_handle(obj) -> None:
    """Have it go along X from frame 1 to 9."""
    for frame, x in ((1, 0.0), (9, 0.8)):
        handle(obj).location.x = x
        handle(obj).keyframe_insert("location", frame=frame)


@pytest.mark.parametrize(("old", "new"), [(100, 200), (200, 100), (100, 100)])
def test_a_scene_whose_time_is_stretched_plays_as_baked(held, old, new):
    key_the_handle(held)
    scene = bpy.context.scene
    scene.render.frame_map_old, scene.render.frame_map_new = old, new
    bake()
    assert_follows(held, (1, 5, 9))


def test_frames_below_0_and_a_frame_between_are_kept(held):
    drive(held)
    scene = bpy.context.scene
    scene.frame_set(3, subframe=0.25)
    bake(-7, 5, 6)
    assert names(held) == ["Basis", "Deformation -7", "Deformation -1", "Deformation 5"]
    assert (scene.frame_current, scene.frame_subframe) == (3, 0.25)
    assert_follows(held, (-7, -1, 5))


def test_the_last_frame_is_baked_whatever_the_step(held):
    drive(held)
    bake(1, 10, 4)
    assert names(held)[1:] == ["Deformation 1", "Deformation 5", "Deformation 9", "Deformation 10"]
    assert_follows(held, (1, 5, 9, 10))
    bake(2, 4, 100)
    assert names(held)[1:] == ["Deformation 2", "Deformation 4"]
    bake(7, 7, 3)
    assert names(held)[1:] == ["Deformation 7"]
    with pytest.raises(RuntimeError, match="frame 3 comes before frame 5"):
        bake(5, 3)


@pytest.mark.parametrize("is_hidden", [False, True])
def test_a_handle_that_falls_is_simulated_from_the_start(held, is_hidden):
    bpy.ops.mesh.primitive_cube_add(size=0.1, location=(0, 0, 2))
    cube = bpy.context.object
    bpy.ops.rigidbody.object_add()
    bpy.context.view_layer.objects.active = held
    held.spectral_tv.constraints[1].target = cube
    scene = bpy.context.scene
    scene.frame_set(1)
    if is_hidden:
        cube.hide_set(True)
    bake(10, 20, 10)
    heights = {}
    for frame in range(1, 21):
        scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        heights[frame] = cube.evaluated_get(graph).matrix_world.translation.z - 2
    assert heights[20] < 2 * heights[10] < -0.1
    head = members(held, "Head")
    for frame in (10, 20):
        moved = (
            key_positions(held, f"Deformation {frame}")[head] - key_positions(held, "Basis")[head]
        )
        np.testing.assert_allclose(moved[:, 2].mean(), heights[frame], atol=1e-4)


def actions_in_another_file(obj, tmp_path: Path) -> bpy.types.Action:
    """Shape keys whose action is linked."""
    obj.shape_key_add(name="Basis")
    obj.shape_key_add(name="Smile").keyframe_insert("value", frame=1)
    animation = obj.data.shape_keys.animation_data
    path = str(tmp_path / "library.blend")
    bpy.data.libraries.write(path, {animation.action}, fake_user=True)
    with bpy.data.libraries.load(path, link=True) as (content, wanted):
        wanted.actions = content.actions
    (linked,) = wanted.actions
    animation.action = linked
    return linked


def test_an_action_of_another_file_is_refused_and_nothing_is_left(held, tmp_path):
    linked = actions_in_another_file(held, tmp_path)
    drive(held)
    before = contents()
    with pytest.raises(RuntimeError, match=r"the action .* of its shape keys belongs to another"):
        bake()
    assert contents() == before
    held.data.shape_keys.animation_data.action = linked.make_local()
    bake()
    assert_follows(held, (1, 5, 9))


def test_tweak_mode_is_refused(held):
    held.shape_key_add(name="Basis")
    held.shape_key_add(name="Smile").keyframe_insert("value", frame=1)
    animation = held.data.shape_keys.animation_data
    track = animation.nla_tracks.new()
    track.strips.new("Smile", 1, animation.action)
    animation.action = None
    animation.nla_tracks.active = track
    animation.use_tweak_mode = True
    before = contents()
    with pytest.raises(RuntimeError, match="Tweak Mode"):
        bake()
    assert contents() == before
    animation.use_tweak_mode = False
    drive(held)
    bake()
    assert_follows(held, (1, 5, 9))


def test_a_refusal_on_one_of_the_frames_names_it_and_nothing_is_left(held):
    held.vertex_groups["Feet"].add([int(index) for index in members(held, "Head")], 1.0, "ADD")
    handle(held).driver_add("location", 0).driver.expression = "0 if frame < 7 else 1"
    scene = bpy.context.scene
    scene.frame_set(2)
    before = contents()
    with pytest.raises(RuntimeError, match=r"on frame 7: .*go to different places"):
        bake(1, 9, 3)
    assert contents() == before
    assert scene.frame_current == 2
    assert len(bpy.data.objects) == 2


@pytest.mark.parametrize("before", ["none", "keys", "keyed", "baked"])
@pytest.mark.parametrize("error", [RuntimeError("full"), MemoryError(), KeyboardInterrupt()])
def test_a_baking_that_fails_leaves_nothing_behind(held, monkeypatch, before, error):
    """Wherever it fails: on the second of its keyframes, say."""
    drive(held)
    if before != "none":
        held.shape_key_add(name="Basis")
        held.shape_key_add(name="Smile")
    if before == "keyed":
        held.data.shape_keys.key_blocks["Smile"].keyframe_insert("value", frame=1)
    if before == "baked":
        bake()
    held.active_shape_key_index = 0
    animation = import_module(f"{MODULE}.scene.animation")
    insert, count = animation.insert_keyframe, 0

    def fail(*arguments):
        nonlocal count
        count += 1
        if count == 4:
            raise error
        return insert(*arguments)

    found, actions = contents(), set(bpy.data.actions)
    monkeypatch.setattr(animation, "insert_keyframe", fail)
    baking = import_module(f"{MODULE}.deformation.baking")
    frames = [1, 5, 9]
    deformable, targets, follower = baking.prepare(held, frames, lambda _fraction: None)
    solved = follower.start_sequence(targets).result()
    with pytest.raises(type(error)):
        baking.write(held, frames, deformable, follower, solved)
    assert contents() == found
    assert set(bpy.data.actions) == actions
    assert (held.data.shape_keys is None) == (before == "none")
    monkeypatch.undo()
    bake()
    assert_follows(held, frames)


def test_an_action_of_several_slots_is_used_by_its_slot(held):
    if "slots" not in bpy.types.Action.bl_rna.properties:
        pytest.skip("this Blender is built without slots of actions")
    key_the_handle(held)
    held.keyframe_insert("location", frame=1)
    held.shape_key_add(name="Basis")
    smile = held.shape_key_add(name="Smile")
    smile.value = 0
    action = held.animation_data.action
    held.data.shape_keys.animation_data_create().action = action
    smile.keyframe_insert("value", frame=1)
    assert len(action.slots) == 2
    for _ in range(2):
        bake()
        assert held.data.shape_keys.animation_data.action == action
        assert_follows(held, (1, 5, 9))
    curves = [
        [curve.data_path for curve in bag.fcurves]
        for layer in action.layers
        for strip in layer.strips
        for bag in strip.channelbags
    ]
    assert sorted(map(len, curves)) == [3, 4]


def test_an_action_that_other_keys_play_too_is_left_to_them(held, capfd):
    twin = dumbbell_object()
    actions = []
    for obj in (held, twin):
        obj.shape_key_add(name="Basis")
        obj.shape_key_add(name="Smile").value = 0
    held.data.shape_keys.key_blocks["Smile"].keyframe_insert("value", frame=1)
    action = held.data.shape_keys.animation_data.action
    animation = twin.data.shape_keys.animation_data_create()
    animation.action = action
    if hasattr(animation, "action_slot"):
        animation.action_slot = action.slots[0]
    constrain(twin, "Feet", "PIN")
    constrain(twin, "Head", "OBJECT", target=empty((0, 0, 2)))
    for obj, expression in ((held, "(frame - 1) / 10"), (twin, "(frame - 1) / -20")):
        handle(obj).driver_add("location", 0).driver.expression = expression
        bpy.context.view_layer.objects.active = obj
        bake()
        actions.append(obj.data.shape_keys.animation_data.action)
    assert "was shared; these shape keys have a copy" in capfd.readouterr().out
    assert len(set(actions)) == 2
    for obj in (held, twin):
        assert_follows(obj, (1, 5, 9))


def test_what_the_nla_mixes_is_told(held, capfd):
    held.shape_key_add(name="Basis")
    held.shape_key_add(name="Smile").keyframe_insert("value", frame=1)
    animation = held.data.shape_keys.animation_data
    animation.nla_tracks.new().strips.new("Smile", 1, animation.action)
    bake()
    assert "NLA" not in capfd.readouterr().out
    animation.action_influence = 0.5
    bake()
    assert "the NLA Editor mixes the action of the shape keys" in capfd.readouterr().out


def test_a_scale_that_changes_on_the_way_is_told(held, capfd):
    held.driver_add("scale", 0).driver.expression = "1 + frame / 10"
    bpy.context.scene.frame_set(2)
    bake()
    assert "its scale is animated: lengths are those of frame 2" in capfd.readouterr().out
