"""The shape keys that hold deformations: which are known, which are seen, what is kept."""

from __future__ import annotations

import bmesh
import bpy
import numpy as np
import pytest
from deform_scene import (
    constrain,
    dumbbell_object,
    empty,
    evaluated,
    handle,
    key_positions,
    members,
)

KEPT = "kept and muted, as changed, renamed, locked or copied since"


def keys(obj):
    return obj.data.shape_keys.key_blocks


def pull(obj, x: float) -> None:
    """Move the handle there and deform."""
    handle(obj).location.x = x
    bpy.context.view_layer.update()
    assert bpy.ops.spectral_tv.deform() == {"FINISHED"}


def animate(obj) -> None:
    """Have the handle go 0.8 along X from frame 1 to 9, evenly."""
    pivot = handle(obj)
    pivot.driver_add("location", 0).driver.expression = "(frame - 1) / 10"
    bpy.context.scene.frame_set(1)


def bake() -> None:
    assert bpy.ops.spectral_tv.bake_deformation(frame_start=1, frame_end=9, step=4) == {"FINISHED"}


def seen(obj) -> np.ndarray:
    """How far along X the head is seen from its rest."""
    head = members(obj, "Head")
    return evaluated(obj)[head, 0] - key_positions(obj, "Basis")[head, 0]


def told(capfd) -> str:
    return capfd.readouterr().out


@pytest.fixture(autouse=True)
def _first_frame():
    yield
    bpy.data.batch_remove(bpy.data.actions)
    bpy.context.scene.frame_set(1)


@pytest.mark.parametrize("how", ["keyed", "driven", "still"])
def test_a_baking_is_seen_alone_whatever_the_value_of_the_last_deformation(held, capfd, how):
    pull(held, 0.8)
    single = keys(held)["Deformation"]
    single.value = 0.5
    if how == "keyed":
        single.keyframe_insert("value", frame=1)
    elif how == "driven":
        single.driver_add("value").driver.expression = "0.5"
    animate(held)
    bake()
    assert "muted, as it would be added: 'Deformation'" in told(capfd)
    for frame in (1, 3, 5, 9):
        bpy.context.scene.frame_set(frame)
        np.testing.assert_allclose(seen(held), (frame - 1) / 10, atol=1e-5)
    animation = held.data.shape_keys.animation_data
    assert single.value == pytest.approx(0.5)
    assert (len(animation.drivers) == 1) == (how == "driven")


def test_a_deformation_between_baked_frames_is_seen_alone(held, capfd):
    animate(held)
    bake()
    bpy.context.scene.frame_set(3)
    told(capfd)
    assert bpy.ops.spectral_tv.deform() == {"FINISHED"}
    np.testing.assert_allclose(seen(held), 0.2, atol=1e-5)
    assert "muted, as it would be added: 'Deformation 1' and 2 more" in told(capfd)
    names = ["Deformation 1", "Deformation 5", "Deformation 9"]
    assert all(keys(held)[name].mute for name in names)
    bake()  # and back
    assert not any(keys(held)[name].mute for name in names)
    np.testing.assert_allclose(seen(held), 0.2, atol=1e-5)


def test_a_result_that_is_muted_or_at_0_is_seen_again(held, capfd):
    pull(held, 0.5)
    keys(held)["Deformation"].mute = True
    pull(held, 0.6)
    np.testing.assert_allclose(seen(held), 0.6, atol=1e-5)
    keys(held)["Deformation"].value = 0
    pull(held, 0.7)
    np.testing.assert_allclose(seen(held), 0.7, atol=1e-5)
    assert "'Deformation' was at 0, and is at 1 now" in told(capfd)


def test_what_the_user_chose_of_a_result_stays_and_is_told(held, capfd):
    pull(held, 0.5)
    key = keys(held)["Deformation"]
    key.value = 0.5
    key.vertex_group = "Head"
    pull(held, 0.6)
    output = told(capfd)
    assert "'Deformation' is at 0.5: 1 shows all of it" in output
    assert "'Deformation' is limited to the vertex group 'Head'" in output
    key.keyframe_insert("value", frame=1)
    key.keyframe_insert("mute", frame=1)
    pull(held, 0.7)
    output = told(capfd)
    assert "the value of 'Deformation' is keyed, 0.5 now: 1 shows all of it" in output
    assert "'Deformation' is not seen where it is muted: that is animated" in output
    assert key.value == 0.5
    key.driver_add("value").driver.expression = "0.25"
    pull(held, 0.8)
    assert "the value of 'Deformation' is driven, 0.25 now" in told(capfd)


def test_a_result_that_another_key_hides_is_told(held, capfd):
    held.shape_key_add(name="Basis")
    held.shape_key_add(name="Smile")
    held.active_shape_key_index = 1
    held.show_only_shape_key = True
    pull(held, 0.5)
    assert "nothing is seen of it" in told(capfd)
    held.active_shape_key_index = keys(held).find("Deformation")
    pull(held, 0.6)
    assert "nothing is seen of it" not in told(capfd)
    np.testing.assert_allclose(seen(held), 0.6, atol=1e-5)


def copy_of(obj, key: bpy.types.ShapeKey, name: str) -> bpy.types.ShapeKey:
    copy = obj.shape_key_add(name=name, from_mix=False)
    copy.value = 0
    copy.data.foreach_set("co", key_positions(obj, key.name).astype(np.float32).ravel())
    return copy


def test_a_copy_of_the_result_is_kept(held):
    pull(held, 0.5)
    copy_of(held, keys(held)["Deformation"], "Keep")
    kept = key_positions(held, "Keep")
    pull(held, 0.8)
    np.testing.assert_array_equal(key_positions(held, "Keep"), kept)
    np.testing.assert_allclose(seen(held), 0.8, atol=1e-5)


def test_a_copy_is_kept_though_the_result_was_sculpted_since(held, capfd):
    pull(held, 0.5)
    copy_of(held, keys(held)["Deformation"], "Keep")
    kept = key_positions(held, "Keep")
    change(held, "Deformation")
    sculpted = key_positions(held)
    pull(held, 0.8)
    np.testing.assert_array_equal(key_positions(held, "Keep"), kept)
    np.testing.assert_array_equal(key_positions(held), sculpted)
    assert f"{KEPT}: 'Keep' and 1 more" in told(capfd)
    np.testing.assert_allclose(seen(held), 0.8, atol=1e-5)


def test_a_renamed_result_with_a_copy_is_kept_with_it_and_told(held, capfd):
    pull(held, 0.5)
    keys(held)["Deformation"].name = "Keep"
    copy_of(held, keys(held)["Keep"], "Other")
    kept = [key_positions(held, name) for name in ("Keep", "Other")]
    pull(held, 0.8)
    assert [key.name for key in keys(held)] == ["Basis", "Keep", "Other", "Deformation"]
    for name, shape in zip(("Keep", "Other"), kept, strict=True):
        np.testing.assert_array_equal(key_positions(held, name), shape)
    assert f"{KEPT}: 'Keep' and 1 more" in told(capfd)
    np.testing.assert_allclose(seen(held), 0.8, atol=1e-5)
    pull(held, 0.3)
    assert len(keys(held)) == 4


@pytest.mark.parametrize("kind", ["CAST", "SUBSURF"])
def test_a_result_is_known_after_a_modifier_was_applied(held, kind):
    animate(held)
    bake()
    pull(held, 0.5)
    handle(held).driver_remove("location")
    held.modifiers.new("Modifier", kind)
    assert bpy.ops.spectral_tv.apply_modifier() == {"FINISHED"}
    handle(held).location.x = 0.7
    assert bpy.ops.spectral_tv.deform() == {"FINISHED"}
    assert len(keys(held)) == 5
    np.testing.assert_allclose(seen(held), 0.7, atol=1e-5)


def test_a_key_of_the_user_that_took_the_name_is_no_result(held, capfd):
    pull(held, 0.5)
    held.shape_key_remove(keys(held)["Deformation"])
    mine = held.shape_key_add(name="Deformation", from_mix=False)
    mine.value = 0
    mine.data[7].co.z += 1
    before = key_positions(held)
    pull(held, 0.8)
    np.testing.assert_array_equal(key_positions(held), before)
    assert not mine.mute and KEPT not in told(capfd)
    np.testing.assert_allclose(seen(held), 0.8, atol=1e-5)


def change(obj, name: str) -> None:
    """Sculpt a little on a key."""
    keys(obj)[name].data[0].co.z += 1


def lock(obj, name: str) -> None:
    keys(obj)[name].lock_shape = True


@pytest.mark.parametrize("of_the_users", [change, lock])
def test_a_result_that_was_changed_or_locked_is_kept(held, capfd, of_the_users):
    pull(held, 0.5)
    of_the_users(held, "Deformation")
    before = key_positions(held)
    told(capfd)
    pull(held, 0.8)
    np.testing.assert_array_equal(key_positions(held), before)
    assert f"{KEPT}: 'Deformation'" in told(capfd)
    assert [key.name for key in keys(held)] == ["Basis", "Deformation", "Deformation.001"]
    np.testing.assert_allclose(seen(held), 0.8, atol=1e-5)
    pull(held, 0.3)
    assert KEPT not in told(capfd)
    assert len(keys(held)) == 3


@pytest.mark.parametrize("of_the_users", [change, lock])
def test_a_baked_key_that_was_changed_or_locked_is_kept(held, capfd, of_the_users):
    animate(held)
    bake()
    of_the_users(held, "Deformation 5")
    before = key_positions(held, "Deformation 5")
    bake()
    np.testing.assert_array_equal(key_positions(held, "Deformation 5"), before)
    assert f"{KEPT}: 'Deformation 5'" in told(capfd)
    for frame in (1, 5, 9):
        bpy.context.scene.frame_set(frame)
        np.testing.assert_allclose(seen(held), (frame - 1) / 10, atol=1e-5)
    bake()
    assert len(keys(held)) == 5


def test_a_result_is_known_though_basis_was_sculpted_or_vertices_were_added(held):
    pull(held, 0.5)
    bpy.ops.object.mode_set(mode="EDIT")
    edited = bmesh.from_edit_mesh(held.data)
    edited.verts.ensure_lookup_table()
    edited.verts[5].co.z += 0.1  # moves the other keys along
    bmesh.update_edit_mesh(held.data)
    bpy.ops.object.mode_set(mode="OBJECT")
    pull(held, 0.6)
    assert [key.name for key in keys(held)] == ["Basis", "Deformation"]
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    bpy.ops.object.mode_set(mode="OBJECT")
    pull(held, 0.7)
    assert [key.name for key in keys(held)] == ["Basis", "Deformation"]
    np.testing.assert_allclose(seen(held), 0.7, atol=1e-5)


def test_keys_of_the_user_that_bear_the_names_of_frames_stay(held):
    held.shape_key_add(name="Basis")
    held.shape_key_add(name="Deformation 5").data[0].co.z += 1
    mine = key_positions(held, "Deformation 5")
    animate(held)
    for _ in range(2):
        bake()
    np.testing.assert_array_equal(key_positions(held, "Deformation 5"), mine)
    assert len(keys(held)) == 5
    for frame in (1, 5, 9):
        bpy.context.scene.frame_set(frame)
        np.testing.assert_allclose(seen(held), (frame - 1) / 10, atol=1e-5)


def test_a_renamed_key_of_a_baking_is_kept(held, capfd):
    animate(held)
    bake()
    keys(held)["Deformation 5"].name = "Middle"
    bake()
    names = ["Basis", "Middle", "Deformation 1", "Deformation 5", "Deformation 9"]
    assert [key.name for key in keys(held)] == names
    assert keys(held)["Middle"].mute
    assert "renamed, locked or copied since: 'Middle'" in capfd.readouterr().out


def twins() -> tuple[bpy.types.Object, bpy.types.Object]:
    """Two objects of one mesh, both held, with handles of their own."""
    one = dumbbell_object()
    other = bpy.data.objects.new("Twin", one.data)
    bpy.context.scene.collection.objects.link(other)
    other.spectral_tv.algorithm = one.spectral_tv.algorithm
    for obj in (one, other):
        constrain(obj, "Feet", "PIN")
        constrain(obj, "Head", "OBJECT", target=empty((0, 0, 2)))
    return one, other


def test_two_objects_with_constraints_do_not_share_a_mesh():
    one, other = twins()
    for operator in (bpy.ops.spectral_tv.deform, bpy.ops.spectral_tv.bake_deformation):
        with pytest.raises(RuntimeError, match="Its mesh is also that of 'Twin'"):
            operator()
    assert one.data.shape_keys is None
    bpy.ops.object.select_all(action="DESELECT")
    one.select_set(True)
    bpy.ops.object.make_single_user(object=True, obdata=True)
    pull(one, 0.5)
    bpy.context.view_layer.objects.active = other
    pull(other, -0.7)
    np.testing.assert_allclose(seen(one), 0.5, atol=1e-5)
    np.testing.assert_allclose(seen(other), -0.7, atol=1e-5)


def test_an_object_without_constraints_follows_its_twin_and_that_is_told(capfd):
    one, other = twins()
    other.spectral_tv.constraints.clear()
    pull(one, 0.5)
    np.testing.assert_allclose(seen(other), 0.5, atol=1e-5)
    assert "2 objects share this mesh and its shape keys" in told(capfd)


def test_other_keys_that_move_what_is_constrained_are_told(held, capfd):
    held.shape_key_add(name="Basis")
    smile = held.shape_key_add(name="Smile")
    smile.value = 0
    for index in members(held, "Head"):
        smile.data[index].co.y += 0.5
    pull(held, 0.5)
    assert "other shape keys" not in told(capfd)
    smile.value = 0.5
    pull(held, 0.5)
    expected = "other shape keys are added, 'Smile': they move constrained vertices by up to 0.25"
    assert expected in told(capfd)
    smile.vertex_group = "Feet"
    pull(held, 0.5)
    assert "other shape keys" not in told(capfd)


def test_modifiers_that_change_what_is_seen_are_told(held, capfd):
    held.modifiers.new("Subdivision", "SUBSURF")
    pull(held, 0.5)
    assert "modifiers" not in told(capfd)
    held.modifiers.new("Array", "ARRAY")
    pull(held, 0.5)
    assert "modifiers act on what is deformed, 'Array'" in told(capfd)
    held.modifiers["Array"].show_viewport = False
    pull(held, 0.5)
    assert "modifiers" not in told(capfd)
