"""What is drawn over a mesh: what constraints hold and pull of it, where it is seen."""

from __future__ import annotations

import importlib

import bpy
import numpy as np
import pytest
from conftest import MODULE
from deform_scene import constrain, coordinates, empty, evaluated, group, members

held_module = importlib.import_module(f"{MODULE}.deformation.held")
overlay = importlib.import_module(f"{MODULE}.deformation.overlay")
PIN, PULL = (0.0, 0.0, 1.0), (1.0, 0.5, 0.0)


@pytest.fixture(autouse=True)
def _listening():
    """As a drawing has the extension do; there is none without a window."""
    overlay._listen()
    yield
    overlay.forget()


def known(obj):
    """What is kept of an object, as if it had been drawn."""
    scene, layer = bpy.context.scene, bpy.context.view_layer
    key = scene.session_uid, layer.name, obj.session_uid
    return overlay._known.setdefault(key, overlay._Drawn()).held


def layer_of(obj, picked=None):
    bpy.context.view_layer.update()
    return known(obj).layer(obj, bpy.context.evaluated_depsgraph_get(), picked)


def wait_no_more(obj) -> None:
    known(obj)._next_look = 0.0


def drawn() -> list[str]:
    context = bpy.context
    found = overlay.drawn(context.view_layer, context.active_object, context.scene)
    return [each.name for each in found]


def test_all_constrained_vertices_are_in_it_at_their_weights(held):
    group(held, "Half", [0], 0.5)
    constrain(held, "Half", "KEY")
    layer = layer_of(held)
    rest = coordinates(held.data.vertices)
    for column, names in ((0, ["Feet"]), (1, ["Head", "Half"])):
        strong = layer.positions[layer.strengths[:, column] > 0]
        theirs = rest[sorted({i for name in names for i in members(held, name)})]
        np.testing.assert_allclose(strong, theirs, atol=1e-6)
    assert layer.strengths[layer.strengths > 0].min() == 1  # vertex 0 is in the head too
    held.spectral_tv.constraints.remove(1)
    assert layer_of(held).strengths[:, 1].max() == 0.5


def test_its_triangles_are_those_of_the_mesh_with_a_constrained_corner(held):
    layer = layer_of(held)
    rest = coordinates(held.data.vertices)
    held.data.calc_loop_triangles()
    every = np.array([triangle.vertices for triangle in held.data.loop_triangles])
    mine = np.isin(every, [*members(held, "Feet"), *members(held, "Head")]).any(axis=1)
    assert 0 < np.count_nonzero(mine) < len(every)
    np.testing.assert_allclose(layer.positions[layer.corners], rest[every[mine]], atol=1e-6)


def test_it_follows_the_shape_that_is_seen(held):
    held.spectral_tv.constraints[1].target.location.x += 0.5
    bpy.ops.spectral_tv.deform()
    wave = held.modifiers.new("Cast", "CAST")
    wave.factor = 0.3
    layer = layer_of(held)
    assert layer.is_exact
    wave.factor = 0.5
    moved = layer_of(held)
    assert moved is not layer and moved.strengths is layer.strengths, "colors stay"
    layer, seen = moved, evaluated(held)
    theirs = seen[sorted(members(held, "Head"))]
    mine = layer.positions[layer.strengths[:, 1] > 0]
    np.testing.assert_allclose(mine, theirs, atol=1e-6)


def test_where_modifiers_add_vertices_it_is_the_mesh_and_its_other_half(held):
    shift = np.array([3.0, 0, 0])
    for vertex in held.data.vertices:
        vertex.co.x += shift[0]
    held.modifiers.new("Mirror", "MIRROR")
    layer = layer_of(held)
    assert not layer.is_exact
    rest = coordinates(held.data.vertices)[members(held, "Feet")]
    both = np.vstack([rest, rest * (-1, 1, 1)])
    mine = layer.positions[layer.strengths[:, 0] > 0]
    np.testing.assert_allclose(mine, both, atol=1e-6)


def test_nothing_is_worked_out_twice(held):
    first = layer_of(held)
    assert layer_of(held) is first
    held.spectral_tv.constraints[1].target.location.x += 1
    held.location.x += 1
    held.rotation_euler.z = 1
    assert layer_of(held) is first, "moving objects change nothing of it"
    held.name = "Renamed"
    assert layer_of(held) is first


def change_the_shape(obj) -> None:
    for vertex in obj.data.vertices:
        vertex.co.z += 0.1


def turn_a_key(obj) -> None:
    obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="Key")
    for point in key.points:
        point.co.x += 0.3
    key.value = 0.5


def paint(obj) -> None:
    obj.vertex_groups["Head"].add([int(i) for i in members(obj, "Head")], 0.25, "REPLACE")


def rename_a_group(obj) -> None:
    obj.vertex_groups["Head"].name = "Skull"


def remove_a_group(obj) -> None:
    obj.vertex_groups.remove(obj.vertex_groups["Head"])


def remove_a_constraint(obj) -> None:
    obj.spectral_tv.constraints.remove(1)


def exchange_the_mesh(obj) -> None:
    obj.data = obj.data.copy()
    obj.data.vertices[0].co.z += 1


def remove_vertices(obj) -> None:
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.remove_doubles(threshold=0.1)
    bpy.ops.object.mode_set(mode="OBJECT")


CHANGES = [
    change_the_shape, turn_a_key, paint, rename_a_group, remove_a_group, remove_a_constraint,
    exchange_the_mesh, remove_vertices,
]  # fmt: skip


@pytest.mark.parametrize("change", CHANGES)
def test_what_changes_is_seen(held, change):
    """The same as if it were drawn for the first time."""
    before = layer_of(held)
    change(held)
    wait_no_more(held)
    after = layer_of(held)
    overlay.forget()
    overlay._listen()
    fresh = layer_of(held)
    for one, other in ((after, fresh), (before, fresh)):
        is_same = len(one.positions) == len(other.positions) and all(
            np.array_equal(getattr(one, name), getattr(other, name))
            for name in ("positions", "corners", "strengths")
        )
        assert is_same == (one is after)


def test_undo_is_seen(held):
    bpy.ops.ed.undo_push(message="before")
    before = layer_of(held)
    paint(held)
    remove_a_constraint(held)
    bpy.ops.ed.undo_push(message="painted")
    name = held.name
    wait_no_more(held)
    assert layer_of(held).strengths[:, 1].max() == 0
    bpy.ops.ed.undo()
    again = layer_of(bpy.data.objects[name])
    np.testing.assert_array_equal(again.strengths, before.strengths)


def test_weights_are_not_read_at_every_move_of_the_shape(held):
    """Reading them is slow, and Blender does not tell of them; they follow a moment later."""
    layer_of(held)
    known(held)._next_look = float("inf")
    paint(held)
    change_the_shape(held)
    layer = layer_of(held)
    assert layer.positions[:, 2].max() == pytest.approx(2.568, abs=1e-3)
    assert layer.strengths.max() == 1 and known(held).wait is not None
    wait_no_more(held)
    assert layer_of(held).strengths[:, 1].max() == 0.25 and known(held).wait is None


def test_what_is_picked_is_drawn_too(body):
    picked = held_module.Picked(members(body, "Feet"), members(body, "Head"), 1442)
    assert len(body.data.vertices) == 1442
    layer = layer_of(body, picked)
    assert np.count_nonzero(layer.strengths, axis=0).tolist() == [
        len(members(body, name)) for name in ("Feet", "Head")
    ]
    assert len(layer_of(body).corners) == 0
    stale = held_module.Picked(np.array([5000]), np.array([5001]), 6000)
    assert len(layer_of(body, stale).corners) == 0, "it is that of a mesh of before"


def test_colors_tell_what_is_held_from_what_is_pulled_and_how_firmly(held):
    paint(held)
    layer = layer_of(held)
    found = overlay.colors(layer, PIN, PULL)
    is_held, is_pulled = (layer.strengths > 0).T
    np.testing.assert_allclose(found[is_held, :3], [PIN] * is_held.sum())
    np.testing.assert_allclose(found[is_pulled, :3], [PULL] * is_pulled.sum())
    assert found[is_held, 3].min() > found[is_pulled, 3].max() > 0
    rim = ~(is_held | is_pulled)
    assert rim.any() and not found[rim, 3].any()
    assert {tuple(each) for each in found[rim, :3]} == {PIN, PULL}
    assert np.isfinite(found).all()


def test_it_is_drawn_for_the_mesh_and_for_what_moves_it(held):
    handle = held.spectral_tv.constraints[1].target
    other = empty()
    for active, expected in ((held, [held.name]), (handle, [held.name]), (other, []), (None, [])):
        bpy.context.view_layer.objects.active = active
        assert drawn() == expected
    held.spectral_tv.constraints[1].target = other
    bpy.context.view_layer.objects.active = handle
    assert drawn() == []
    bpy.context.view_layer.objects.active = other
    assert drawn() == [held.name]
    held.name = "Renamed"
    bpy.context.view_layer.update()
    assert drawn() == ["Renamed"]
    bpy.data.objects.remove(held)
    assert drawn() == []


def test_it_ends_with_the_file_and_with_the_extension(held):
    layer_of(held)
    handlers = bpy.app.handlers
    assert overlay._notice in handlers.depsgraph_update_post and overlay._known
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    assert not overlay._known
    overlay._listen()
    bpy.ops.preferences.addon_disable(module=MODULE)
    try:
        for listeners in (handlers.depsgraph_update_post, handlers.undo_post):
            assert not [each for each in listeners if each.__module__ == overlay.__name__]
    finally:
        bpy.ops.preferences.addon_enable(module=MODULE)
