"""Constraints made of places that are pointed at; in scripts by points and radii."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from ball import ball
from deform_scene import constrain, coordinates, group, key_positions, members


def patch(point, radius: float = 0.0, name: str = "") -> dict:
    return {"name": name, "point": point, "radius": radius}


# The poles of a dumbbell, whose balls have the radius 1.
FOOT, CROWN = (0, 0, -2.468), (0, 0, 2.468)
FEET, HEAD = patch(FOOT, 0.6), patch(CROWN, 0.5)


def hold_and_pull(*held, pulled=()) -> set[str]:
    return bpy.ops.spectral_tv.hold_and_pull(held=list(held), pulled=list(pulled))


def kinds(obj) -> list[tuple[str, str]]:
    return [(each.kind, each.vertex_group) for each in obj.spectral_tv.constraints]


def test_a_pin_and_a_handle_come_of_two_points(body):
    body.vertex_groups.clear()
    assert hold_and_pull(FEET, pulled=[HEAD]) == {"FINISHED"}
    assert kinds(body) == [("PIN", "Pin"), ("OBJECT", "Handle")]
    rest = coordinates(body.data.vertices)
    for name, disc in (("Pin", FEET), ("Handle", HEAD)):
        inside = members(body, name)
        straight = np.linalg.norm(rest - disc["point"], axis=1)
        assert straight[inside].max() <= disc["radius"]
        assert set(np.flatnonzero(straight < 0.8 * disc["radius"])) <= set(inside)
    handle = body.spectral_tv.constraints[1].target
    middle = rest[members(body, "Handle")].mean(axis=0)
    np.testing.assert_allclose(handle.matrix_world.translation, middle, atol=1e-6)
    assert bpy.context.view_layer.objects.active == handle
    assert bpy.context.selected_objects == [handle]


def test_what_was_made_deforms_at_once(body):
    hold_and_pull(FEET, pulled=[HEAD])
    handle = bpy.context.object
    handle.location.x += 0.5
    bpy.context.view_layer.objects.active = body
    bpy.ops.spectral_tv.deform()
    shift = key_positions(body) - key_positions(body, "Basis")
    assert np.abs(shift[members(body, "Handle")] - (0.5, 0, 0)).max() < 1e-5
    assert np.abs(shift[members(body, "Pin")]).max() < 1e-5


def test_lengths_are_those_of_the_scene_and_points_those_that_are_seen(body):
    body.scale, body.location = (2, 2, 2), (5, 0, 0)
    body.rotation_euler.x = np.pi
    bpy.context.view_layer.update()
    hold_and_pull(patch((5, 0, 4.94), 1.2), pulled=[patch((5, 0, -4.94), 1)])
    rest = coordinates(body.data.vertices)
    straight = np.linalg.norm(rest - FOOT, axis=1)
    inside = members(body, "Pin")
    assert straight[inside].max() <= 0.6 and len(inside) >= np.count_nonzero(straight < 0.48)


def test_a_radius_of_0_is_a_tenth_of_the_size(body):
    hold_and_pull(patch(FOOT))
    rest = coordinates(body.data.vertices)
    straight = np.linalg.norm(rest[members(body, "Pin")] - FOOT, axis=1)
    size = np.linalg.norm(np.ptp(rest, axis=0))
    assert 0.05 * size < straight.max() <= 0.1 * size


def test_patches_are_named_and_those_of_one_name_are_one_pin(body):
    hold_and_pull(
        patch(FOOT, 0.3, "Foot"), patch((0, 0.25, 0), 0.2, "Waist"),
        patch((0, 0.5, -2.3), 0.3, "Foot"), pulled=[patch(CROWN, 0.2, "Crown")]
    )  # fmt: skip
    assert kinds(body) == [("PIN", "Foot"), ("PIN", "Waist"), ("OBJECT", "Crown")]
    assert members(body, "Foot").size > members(body, "Waist").size


def test_all_that_is_held_is_one_pin_and_each_that_is_pulled_a_handle(body):
    hold_and_pull(FEET, patch((1, 0, -1.468)), pulled=[HEAD, patch((1, 0, 1.468), 0.3)])
    assert [kind for kind, _ in kinds(body)] == ["PIN", "OBJECT", "OBJECT"]
    rest = coordinates(body.data.vertices)[members(body, "Pin")]
    assert rest[:, 2].min() < -2.4 and rest[:, 0].max() > 0.95
    one, two = (set(members(body, name)) for _, name in kinds(body)[1:])
    assert one and two and not one & two


def test_nothing_is_pulled_to_two_places(body, capfd):
    """What is constrained already is left out, and that is told; else nothing could be deformed."""
    constrain(body, "Feet", "PIN")
    constrain(body, "Head", "OBJECT", target=bpy.data.objects.new("Other", None))
    bpy.context.scene.collection.objects.link(body.spectral_tv.constraints[1].target)
    hold_and_pull(pulled=[patch((0.8, 0, 1.468), 0.9)])
    mine = set(members(body, "Handle"))
    assert mine and not mine & set(members(body, "Head"))
    assert "picked vertices are left out, as they are held or pulled" in capfd.readouterr().out


def test_a_place_that_is_taken_is_refused(body):
    constrain(body, "Feet", "PIN")
    with pytest.raises(RuntimeError, match="held or pulled already"):
        hold_and_pull(pulled=[FEET])
    assert len(body.spectral_tv.constraints) == 1 and len(body.vertex_groups) == 2
    hold_and_pull(FEET)  # held twice is held
    assert len(body.spectral_tv.constraints) == 2


def test_patches_spread_along_the_surface():
    """Two sheets that nearly touch: a patch on one has nothing of the other."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=20, y_subdivisions=20)
    obj = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.duplicate_move(TRANSFORM_OT_translate={"value": (0, 0, 0.02)})
    bpy.ops.object.mode_set(mode="OBJECT")
    hold_and_pull(patch((0, 0, 0.021), 0.5))
    rest = coordinates(obj.data.vertices)[members(obj, "Pin")]
    assert len(rest) > 50
    assert (rest[:, 2] > 0.01).all()


def test_corners_joined_at_open_edges_are_one_surface():
    """As of an STL file: three vertices to each triangle."""
    obj = ball("Soup")
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.edge_split()
    bpy.ops.object.mode_set(mode="OBJECT")
    hold_and_pull(patch((0, 0, 1), 0.5))
    assert len(members(obj, "Pin")) > 30


@pytest.mark.parametrize("levels", [0, 1])
def test_the_other_half_is_held_too(levels):
    """It is clicked on where modifiers show it, and its twin becomes the group."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=10, y_subdivisions=10, location=(1.5, 0, 0))
    bpy.ops.object.transform_apply(location=True)
    obj = bpy.context.object
    obj.modifiers.new("Mirror", "MIRROR")
    if levels:
        obj.modifiers.new("Subdivision", "SUBSURF").levels = levels
    bpy.context.view_layer.update()
    hold_and_pull(patch((-2.5, 1, 0), 0.5))
    rest = coordinates(obj.data.vertices)[members(obj, "Pin")]
    assert len(rest) > 1
    assert np.linalg.norm(rest - (2.5, 1, 0), axis=1).max() <= 0.5


def test_points_are_on_the_shape_that_keys_show(body):
    body.shape_key_add(name="Basis")
    up = body.shape_key_add(name="Up")
    for point in up.points:
        point.co.z += 10
    up.value = 1
    hold_and_pull(patch((0, 0, 12.468 - 4.936), 0.5))
    assert coordinates(body.data.vertices)[members(body, "Pin"), 2].max() < 0


def test_without_a_place_nothing_is_made(body):
    with pytest.raises(RuntimeError, match="nothing is given to hold or to pull"):
        hold_and_pull()
    assert not body.spectral_tv.constraints


def test_what_modifiers_leave_nothing_of_is_refused(body):
    body.vertex_groups.new(name="None")
    body.modifiers.new("Mask", "MASK").vertex_group = "None"
    with pytest.raises(RuntimeError, match="its modifiers leave no face of it"):
        hold_and_pull(FEET)


def test_a_place_nowhere_is_refused(body):
    with pytest.raises(RuntimeError, match="no place on it is nearest to that point"):
        hold_and_pull(patch((float("nan"), 0, 0)))


def test_a_vertex_nowhere_is_refused_and_nothing_made(body):
    body.data.vertices[5].co.x = float("nan")
    with pytest.raises(RuntimeError, match="vertex 5"):
        hold_and_pull(FEET)
    assert len(body.vertex_groups) == 2


@pytest.mark.parametrize("mode", ["EDIT", "SCULPT", "WEIGHT_PAINT"])
def test_it_is_for_object_mode(body, mode):
    bpy.ops.object.mode_set(mode=mode)
    with pytest.raises(RuntimeError, match=f"Leave {mode.replace('_', ' ').title()} Mode first"):
        hold_and_pull(FEET)


def test_hidden_objects_are_refused(body):
    body.hide_set(True)
    with pytest.raises(RuntimeError, match="is hidden; show it first"):
        hold_and_pull(FEET)


def test_messages_in_object_mode_offer_the_button(body):
    body.vertex_groups.clear()
    with pytest.raises(RuntimeError, match="press Hold & Pull, then click what stays"):
        bpy.ops.spectral_tv.constraint_add(kind="PIN")
    with pytest.raises(RuntimeError, match="press Hold & Pull, then click what stays"):
        bpy.ops.spectral_tv.deform()


def test_groups_that_are_there_keep_their_names(body):
    group(body, "Pin", [0])
    hold_and_pull(FEET)
    assert kinds(body) == [("PIN", "Pin.001")]
    assert list(members(body, "Pin")) == [0]
