"""What users change of an object while it is deformed live."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from deform_scene import (
    constrain,
    empty,
    evaluated,
    follows,
    group,
    handle,
    key_positions,
    live_of,
    members,
    update,
)
from mathutils import Vector
from spectral_tv.refusal import Refusal


@pytest.fixture
def limbs(held):
    """A dumbbell with a pin at its lower end and handles at its top and its right side."""
    basis = np.array([vertex.co for vertex in held.data.vertices])
    group(held, "Side", np.flatnonzero((basis[:, 0] > 0.97) & (basis[:, 2] > 0)))
    constrain(held, "Side", "OBJECT", target=empty((1, 0, 1)))
    return held


def offset(obj, name: str) -> np.ndarray:
    """By what a group is moved, the same for all its vertices."""
    moved = (key_positions(obj) - key_positions(obj, "Basis"))[members(obj, name)]
    np.testing.assert_allclose(moved, np.tile(moved[0], (len(moved), 1)), atol=1e-5)
    return moved[0]


def drag(live, obj, *places: float) -> None:
    """Move the handles that there are along Y."""
    handles = [each.target for each in obj.spectral_tv.constraints if each.kind == "OBJECT"]
    for target, y in zip(handles, places, strict=True):
        target.location.y = y
    bpy.context.view_layer.update()
    update(live)


def test_a_constraint_that_is_removed_leaves_the_others_theirs(limbs):
    live = live_of(limbs)
    drag(live, limbs, 0.2, 0.4)
    limbs.spectral_tv.constraints.remove(0)  # the pin
    drag(live, limbs, 0.3, 0.5)
    np.testing.assert_allclose(offset(limbs, "Head"), (0, 0.3, 0), atol=1e-5)
    np.testing.assert_allclose(offset(limbs, "Side"), (0, 0.5, 0), atol=1e-5)
    live.settle()
    limbs.spectral_tv.constraints.remove(0)  # the first handle
    drag(live, limbs, 0.6)
    np.testing.assert_allclose(offset(limbs, "Side"), (0, 0.6, 0), atol=1e-5)
    assert np.ptp(key_positions(limbs)[:, 1] - key_positions(limbs, "Basis")[:, 1]) < 1e-5


def test_constraints_that_change_places_keep_their_handles(limbs):
    live = live_of(limbs)
    drag(live, limbs, 0.2, 0.4)
    limbs.spectral_tv.constraints.move(2, 0)
    drag(live, limbs, 0.4, 0.2)
    np.testing.assert_allclose(offset(limbs, "Side"), (0, 0.4, 0), atol=1e-5)
    np.testing.assert_allclose(offset(limbs, "Head"), (0, 0.2, 0), atol=1e-5)
    np.testing.assert_allclose(offset(limbs, "Feet"), 0, atol=1e-5)


def test_a_constraint_that_is_added_holds(held):
    live = live_of(held)
    drag(live, held, 0.2)
    ring = [v.index for v in held.data.vertices if abs(v.co.z) < 0.2]
    group(held, "Ring", ring)
    constrain(held, "Ring", "PIN")
    drag(live, held, 0.5)
    np.testing.assert_allclose(offset(held, "Ring"), 0, atol=1e-5)
    np.testing.assert_allclose(offset(held, "Head"), (0, 0.5, 0), atol=1e-5)


def test_what_a_constraint_is_may_change(limbs):
    """Its kind, its group, its object, its bone, its rest."""
    live = live_of(limbs)
    drag(live, limbs, 0.2, 0.4)
    _, head, side = limbs.spectral_tv.constraints
    side.kind = "PIN"
    update(live)
    np.testing.assert_allclose(offset(limbs, "Side"), 0, atol=1e-5)
    head.vertex_group, side.vertex_group = "Side", "Head"
    update(live)
    np.testing.assert_allclose(offset(limbs, "Side"), (0, 0.2, 0), atol=1e-5)
    np.testing.assert_allclose(offset(limbs, "Head"), 0, atol=1e-5)
    head.target = empty((3, 0, 0))
    head.target.location.y = 0.7
    update(live)
    np.testing.assert_allclose(offset(limbs, "Side"), (0, 0.7, 0), atol=1e-5)
    head.set_rest()
    update(live)
    np.testing.assert_allclose(offset(limbs, "Side"), 0, atol=1e-5)
    side.kind = "KEY"
    side.shape_key = "Smile"
    limbs.shape_key_add(name="Smile", from_mix=False).value = 0
    for point in limbs.data.shape_keys.key_blocks["Smile"].data:
        point.co.z += 0.3
    update(live)
    np.testing.assert_allclose(offset(limbs, "Head"), (0, 0, 0.3), atol=1e-5)


def test_weights_that_are_painted_act(limbs):
    live = live_of(limbs)
    drag(live, limbs, 0.5, 0)
    live.settle()
    np.testing.assert_allclose(offset(limbs, "Head"), (0, 0.5, 0), atol=1e-5)
    indices = [int(index) for index in members(limbs, "Head")]
    limbs.vertex_groups["Head"].add(indices, 0.01, "REPLACE")
    assert follows(live)
    live.settle()
    moved = (key_positions(limbs) - key_positions(limbs, "Basis"))[members(limbs, "Head"), 1]
    assert moved.min() < 0.45


def test_softness_acts_at_once(held):
    live = live_of(held)
    drag(live, held, 0.5)
    live.settle()
    stretched = []
    for softness in (5, 60):
        held.spectral_tv.softness = softness
        update(live)
        live.settle()
        moved = (key_positions(held) - key_positions(held, "Basis"))[:, 1]
        between = (moved > 0.02) & (moved < 0.48)
        stretched.append(np.ptp(key_positions(held, "Basis")[between, 2]))
    assert stretched[1] > 1.5 * stretched[0]


def test_another_algorithm_ends_it_and_is_told(held):
    live = live_of(held)
    update(live)
    held.spectral_tv.algorithm = "ARAP"
    with pytest.raises(
        Refusal, match="Live and Bake Animation need the algorithm Pose or Total Variation"
    ):
        update(live)


def test_a_shape_that_is_sculpted_is_read_anew(held):
    live = live_of(held)
    drag(live, held, 0.5)
    live.settle()
    basis = held.data.shape_keys.reference_key
    for point in basis.data:
        point.co.z *= 2
    assert follows(live)
    np.testing.assert_allclose(offset(held, "Head"), (0, 0.5, 0), atol=1e-5)


def test_an_object_that_is_scaled_is_measured_anew(held):
    live = live_of(held)
    drag(live, held, 0.5)
    live.settle()
    held.scale = (1, 1, 3)
    held.rotation_euler.x = 0.5
    bpy.context.view_layer.update()
    assert update(live)
    live.settle()
    settled = key_positions(held)
    bpy.ops.spectral_tv.deform()
    np.testing.assert_allclose(settled, key_positions(held), atol=0.02)


def test_it_waits_while_something_is_wrong_and_tells_what(limbs):
    live = live_of(limbs)
    drag(live, limbs, 0.2, 0.4)
    before = key_positions(limbs)
    side = limbs.spectral_tv.constraints[2]
    target = side.target

    def assert_waits(problem: str) -> None:
        for _ in range(2):
            assert not update(live)
            assert problem in live.problem
        np.testing.assert_array_equal(key_positions(limbs), before)

    side.target = None
    assert_waits("the object that moves 'Side' is missing")
    side.target = target
    side.vertex_group = "Nothing"
    assert_waits("there is no vertex group 'Nothing'")
    side.vertex_group = "Side"
    target.hide_viewport = True
    assert_waits("Blender does not move what is hidden, 'Handle.001'; show it")
    target.hide_viewport = False
    bpy.context.view_layer.update()
    assert follows(live)
    assert live.problem == ""
    target.hide_set(True)  # by the eye: Blender moves it
    target.location.x += 0.1
    bpy.context.view_layer.update()
    assert update(live)
    for collection in target.users_collection:
        collection.objects.unlink(target)
    before = key_positions(limbs)
    assert_waits("the object 'Handle.001' that moves 'Side' was deleted")
    bpy.context.scene.collection.objects.link(target)
    target.location.x += 0.1
    update(live)
    assert live.problem == ""
    assert offset(limbs, "Side")[0] == pytest.approx(0.2, abs=1e-5)


def test_it_does_not_start_with_what_is_hidden(held):
    handle(held).hide_viewport = True
    with pytest.raises(Refusal, match="Blender does not move what is hidden, 'Handle'"):
        live_of(held)


def test_it_is_seen_alone_from_the_start_and_may_be_muted_then(held):
    bpy.ops.spectral_tv.deform()
    key = held.data.shape_keys.key_blocks["Deformation"]
    key.mute = True
    handle(held).driver_add("location", 0).driver.expression = "(frame - 1) / 10"
    bpy.ops.spectral_tv.bake_deformation(frame_start=1, frame_end=9, step=4)
    bpy.context.scene.frame_set(3)
    live = live_of(held)
    update(live)
    live.settle()
    head = members(held, "Head")
    seen = evaluated(held)[head, 0] - key_positions(held, "Basis")[head, 0]
    np.testing.assert_allclose(seen, 0.2, atol=1e-5)
    key.mute = True
    handle(held).location += Vector((0, 0.1, 0))
    bpy.context.view_layer.update()
    assert update(live)
    assert key.mute
    bpy.context.scene.frame_set(1)
