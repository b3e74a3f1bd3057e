"""Handles wherever they are: hidden, deleted, elsewhere, just moved, flat, posed."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from deform_scene import armature, constrain, empty, handle, key_positions, members


def moved(obj, name: str = "Deformation", group: str = "Head") -> np.ndarray:
    """How far a group was moved along X."""
    head = members(obj, group)
    return (key_positions(obj, name) - key_positions(obj, "Basis"))[head, 0]


def keyed(obj, name: str = "location") -> None:
    """Have it go from 0 to 0.8 along X from frame 1 to 9."""
    for frame, x in ((1, 0.0), (9, 0.8)):
        setattr(obj, name, (x, 0, 2))
        obj.keyframe_insert(name, frame=frame)


def new_collection(obj) -> bpy.types.Collection:
    """Put an object into a collection of its own."""
    collection = bpy.data.collections.new("Hidden")
    bpy.context.scene.collection.children.link(collection)
    for other in obj.users_collection:
        other.objects.unlink(obj)
    collection.objects.link(obj)
    return collection


def layer_of(collection) -> bpy.types.LayerCollection:
    return bpy.context.view_layer.layer_collection.children[collection.name]


def hide_viewport(obj):
    obj.hide_viewport = True


def hide_by_eye(obj):
    obj.hide_set(True)


def hide_in_renders(obj):
    obj.hide_render = True


def hide_collection(obj):
    new_collection(obj).hide_viewport = True


def hide_collection_by_eye(obj):
    layer_of(new_collection(obj)).hide_viewport = True


def exclude_collection(obj):
    layer_of(new_collection(obj)).exclude = True


def hide_on_some_frames(obj):
    for frame, is_hidden in ((1, False), (3, True), (7, False)):
        obj.hide_viewport = is_hidden
        obj.keyframe_insert("hide_viewport", frame=frame)
    obj.hide_viewport = False


def move_to_another_scene(obj):
    other = bpy.data.scenes.get("Other") or bpy.data.scenes.new("Other")
    for collection in obj.users_collection:
        collection.objects.unlink(obj)
    other.collection.objects.link(obj)


WAYS = [
    hide_viewport,
    hide_by_eye,
    hide_in_renders,
    hide_collection,
    hide_collection_by_eye,
    exclude_collection,
    hide_on_some_frames,
    move_to_another_scene,
]


@pytest.fixture(autouse=True)
def _one_scene_without_collections():
    yield
    bpy.data.batch_remove([*bpy.data.collections, *bpy.data.actions])
    for scene in [each for each in bpy.data.scenes if each != bpy.context.scene]:
        bpy.data.scenes.remove(scene)
    bpy.context.scene.frame_set(1)


@pytest.mark.parametrize("hide", WAYS)
def test_a_hidden_handle_moves(held, hide):
    pivot = handle(held)
    keyed(pivot)
    bpy.context.scene.frame_set(1)
    before = set(bpy.data.objects)
    hide(pivot)
    bpy.context.scene.frame_set(5)
    bpy.ops.spectral_tv.deform()
    np.testing.assert_allclose(moved(held), 0.4, atol=1e-5)
    bpy.ops.spectral_tv.bake_deformation(frame_start=1, frame_end=9, step=4)
    for frame, x in ((1, 0.0), (5, 0.4), (9, 0.8)):
        np.testing.assert_allclose(moved(held, f"Deformation {frame}"), x, atol=1e-5)
    bpy.context.scene.frame_set(9)
    bpy.ops.spectral_tv.deform()
    np.testing.assert_allclose(moved(held), 0.8, atol=1e-5)
    assert set(bpy.data.objects) == before


def test_an_unkeyed_change_of_a_keyed_handle_counts_though_another_is_hidden(held):
    pivot, hidden = handle(held), empty()
    keyed(pivot)
    keyed(hidden)
    bpy.context.scene.frame_set(1)
    hidden.hide_viewport = True
    constrain(held, "Feet", "OBJECT", target=hidden)
    held.spectral_tv.constraints.remove(0)
    bpy.context.scene.frame_set(9)
    pivot.location.x = 0.3
    bpy.ops.spectral_tv.deform()
    np.testing.assert_allclose(moved(held), 0.3, atol=1e-5)
    np.testing.assert_allclose(moved(held, group="Feet"), 0.8, atol=1e-5)


def test_what_a_hidden_handle_hangs_on_moves_it(held):
    """A parent that is driven, hidden too."""
    pivot, parent = handle(held), empty()
    parent.driver_add("location", 0).driver.expression = "(frame - 1) / 10"
    pivot.parent = parent
    for each in (pivot, parent):
        each.hide_viewport = True
    bpy.context.scene.frame_set(6)
    bpy.ops.spectral_tv.deform()
    np.testing.assert_allclose(moved(held), 0.5, atol=1e-5)


def test_a_handle_whose_animation_is_in_the_nla_moves(held):
    pivot = handle(held)
    keyed(pivot)
    animation = pivot.animation_data
    animation.nla_tracks.new().strips.new("Go", 11, animation.action)
    animation.action = None
    pivot.hide_viewport = True
    bpy.ops.spectral_tv.bake_deformation(frame_start=11, frame_end=19, step=8)
    np.testing.assert_allclose(moved(held, "Deformation 19"), 0.8, atol=1e-5)


@pytest.mark.parametrize("hide", [hide_by_eye, exclude_collection])
def test_the_bones_of_a_hidden_armature_move(body, hide):
    rig, pose = armature()
    constrain(body, "Feet", "PIN")
    constrain(body, "Head", "OBJECT", target=rig, bone="Neck")
    for frame, x in ((1, 0.0), (9, 0.8)):
        pose.location = (x, 0, 0)
        pose.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(1)
    hide(rig)
    bpy.ops.spectral_tv.bake_deformation(frame_start=1, frame_end=9, step=8)
    np.testing.assert_allclose(np.abs(moved(body, "Deformation 9")), 0.8, atol=1e-5)
    np.testing.assert_allclose(moved(body, "Deformation 1"), 0, atol=1e-5)


def test_a_hidden_mesh_object_moves_against_its_handle(held):
    for frame, x in ((1, 0.0), (9, 0.8)):
        held.location.x = x
        held.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(1)
    held.hide_viewport = True
    bpy.context.scene.frame_set(9)
    bpy.ops.spectral_tv.deform()
    np.testing.assert_allclose(moved(held), -0.8, atol=1e-5)


def test_an_armature_in_rest_position_is_told(body, capfd):
    rig, pose = armature()
    constrain(body, "Feet", "PIN")
    constrain(body, "Head", "OBJECT", target=rig, bone="Neck")
    pose.location.x = 1
    rig.data.pose_position = "REST"
    bpy.ops.spectral_tv.deform()
    assert "the armature 'Rig' is in Rest Position: its bones do not move" in capfd.readouterr().out


def test_a_deleted_handle_pulls_no_more(held):
    pivot = handle(held)
    pivot.location.x = 1
    bpy.context.view_layer.update()
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj == pivot)
    bpy.ops.object.delete()
    assert handle(held) is not None  # its ghost
    bpy.context.view_layer.objects.active = held
    told = "the object 'Handle' that moves 'Head' was deleted"
    for operator in (bpy.ops.spectral_tv.deform, bpy.ops.spectral_tv.bake_deformation):
        with pytest.raises(RuntimeError, match=told):
            operator()
    held.spectral_tv.active = 1
    with pytest.raises(RuntimeError, match=told):
        bpy.ops.spectral_tv.constraint_rest()
    assert held.data.shape_keys is None


def test_rest_is_where_the_handle_is_even_if_it_was_just_moved(body):
    pivot = empty()
    constrain(body, "Feet", "PIN")
    pivot.location = (1, 0, 0)  # not evaluated
    constraint = constrain(body, "Head", "OBJECT", target=pivot)
    bpy.ops.spectral_tv.deform()
    np.testing.assert_allclose(moved(body), 0, atol=1e-6)

    pivot.location.x = 3
    body.location.x = 1  # as is the mesh object
    body.spectral_tv.active = 1
    bpy.ops.spectral_tv.constraint_rest()
    bpy.ops.spectral_tv.deform()
    np.testing.assert_allclose(moved(body), 0, atol=1e-6)

    rig, pose = armature()
    pose.location.x = 1
    constraint.target = rig
    constraint.bone = "Neck"
    bpy.ops.spectral_tv.deform()
    np.testing.assert_allclose(moved(body), 0, atol=1e-6)

    hidden = empty()
    hidden.hide_viewport = True
    hidden.location.x = 5
    constraint.target = hidden
    hidden.location.x = 6
    bpy.ops.spectral_tv.deform()
    np.testing.assert_allclose(moved(body), 1, atol=1e-6)


@pytest.mark.parametrize("scale", [(1, 1, 0), (0, 0, 0), (1, 1e-6, 1)])
def test_a_handle_that_is_flat_at_rest_is_refused(body, scale):
    pivot = empty()
    pivot.scale = scale
    constrain(body, "Feet", "PIN")
    constrain(body, "Head", "OBJECT", target=pivot)
    with pytest.raises(RuntimeError, match="'Handle' that moves 'Head' was flat or missing"):
        bpy.ops.spectral_tv.deform()
    body.spectral_tv.active = 1
    with pytest.raises(RuntimeError, match="'Handle' that moves 'Head' is flat"):
        bpy.ops.spectral_tv.constraint_rest()
    pivot.scale = (1, 1, 1)
    bpy.ops.spectral_tv.constraint_rest()
    pivot.scale.z = 0  # what was not flat at rest may become so
    bpy.ops.spectral_tv.deform()
    head = key_positions(body)[members(body, "Head"), 2]
    np.testing.assert_allclose(head, 0, atol=1e-6)


def test_a_bone_that_came_later_has_no_rest_yet(body):
    rig, _ = armature()
    constrain(body, "Feet", "PIN")
    constraint = constrain(body, "Head", "OBJECT", target=rig, bone="Tail")
    with pytest.raises(RuntimeError, match="the bone 'Tail' that moves 'Head' is missing"):
        bpy.ops.spectral_tv.deform()
    rig.data.bones["Neck"].name = "Tail"
    with pytest.raises(RuntimeError, match="press Set Rest"):
        bpy.ops.spectral_tv.deform()
    constraint.set_rest()
    bpy.ops.spectral_tv.deform()


def test_places_far_from_the_origin_are_exact(held):
    """Of 1e5 single precision has two digits after the point; the handle moves by less."""
    pivot = handle(held)
    for obj in (held, pivot):
        obj.location.x += 100_000
    held.spectral_tv.constraints[1].target = pivot
    bpy.context.view_layer.update()
    bpy.ops.spectral_tv.deform()
    np.testing.assert_allclose(moved(held), 0, atol=1e-6)
    pivot.location.x += 0.5
    bpy.ops.spectral_tv.deform()
    np.testing.assert_allclose(moved(held), 0.5, atol=1e-6)
