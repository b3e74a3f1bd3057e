"""The masks of bands: painted, made of other things and changed, in every mode."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from ball import ball
from contents import contents, differences
from deform_scene import constrain, evaluated, key_positions
from masked_ball import BANDS, MASKS, SMALL, heights, keys, mask, own, paint, select, weights

OPS = bpy.ops.spectral_tv


@pytest.fixture
def banded():
    """A ball with three bands, the second one at 1.5."""
    obj = ball("Ball")
    OPS.decompose(**SMALL)
    keys(obj)[BANDS[1]].value = 1.5
    return obj


@pytest.fixture
def masked(banded):
    """The same, that band masked where z > 0."""
    select(banded, heights(banded) > 0)
    OPS.fill_mask(band=2)
    return banded


@pytest.mark.parametrize("mode", ["OBJECT", "EDIT", "SCULPT", "VERTEX_PAINT"])
def test_the_brush_makes_a_mask_and_comes_back_to_the_mode_it_came_from(banded, mode, capfd):
    seen = evaluated(banded)
    bpy.ops.ed.undo_push(message="without it Sculpt Mode has no undo in the background")
    bpy.ops.object.mode_set(mode=mode)
    assert OPS.paint_mask(band=2) == {"FINISHED"}
    assert banded.mode == "WEIGHT_PAINT"
    assert keys(banded)[BANDS[1]].vertex_group == banded.vertex_groups.active.name == MASKS[1]
    assert f"'{MASKS[1]}' is the new mask; paint weight 0" in capfd.readouterr().out
    assert mask(banded) == pytest.approx(1)
    np.testing.assert_array_equal(evaluated(banded), seen)
    paint(banded, MASKS[1], np.flatnonzero(heights(banded) < 0))
    moved = key_positions(banded, BANDS[1]) - key_positions(banded, "Basis")
    shown = key_positions(banded, "Basis") + 1.5 * (heights(banded) >= 0)[:, np.newaxis] * moved
    np.testing.assert_allclose(evaluated(banded), shown, atol=1e-6)
    assert np.abs(shown - seen).max() > 1e-4
    assert OPS.paint_mask(band=2) == {"FINISHED"}
    assert banded.mode == mode
    # Once it is there, it is painted on.
    OPS.paint_mask(band=2)
    assert banded.mode == "WEIGHT_PAINT" and banded.vertex_groups.keys() == ["Cap", MASKS[1]]
    assert mask(banded).min() == 0


def test_from_one_band_to_another_without_leaving_weight_paint(masked):
    OPS.paint_mask(band=2)
    OPS.paint_mask(band=3, weight=0)
    assert masked.mode == "WEIGHT_PAINT" and masked.vertex_groups.active.name == MASKS[2]
    assert not mask(masked, 3).any()
    OPS.paint_mask(band=2)
    assert masked.mode == "WEIGHT_PAINT" and masked.vertex_groups.active.name == MASKS[1]
    OPS.paint_mask(band=2)
    assert masked.mode == "OBJECT"


@pytest.mark.parametrize("mode", ["OBJECT", "EDIT", "SCULPT"])
def test_the_brush_is_undone_with_its_mode(banded, mode):
    bpy.ops.ed.undo_push(message="without it Sculpt Mode has no undo in the background")
    bpy.ops.object.mode_set(mode=mode)
    bpy.ops.ed.undo_push(message="before")
    before = contents()
    OPS.paint_mask("EXEC_DEFAULT", True, band=2)
    after = contents()
    for _ in range(2):
        bpy.ops.ed.undo()
        assert bpy.context.object.mode == mode and contents() == before
        bpy.ops.ed.redo()
        assert bpy.context.object.mode == "WEIGHT_PAINT" and contents() == after


@pytest.mark.parametrize("mode", ["OBJECT", "SCULPT"])
def test_the_way_back_is_undone_too(banded, mode):
    """But for Edit Mode, of which Blender keeps what is edited alone."""
    bpy.ops.ed.undo_push(message="without it Sculpt Mode has no undo in the background")
    bpy.ops.object.mode_set(mode=mode)
    OPS.paint_mask("EXEC_DEFAULT", True, band=2)
    painting = contents()
    OPS.paint_mask("EXEC_DEFAULT", True, band=2)
    back = contents()
    for _ in range(2):
        bpy.ops.ed.undo()
        assert bpy.context.object.mode == "WEIGHT_PAINT" and contents() == painting
        bpy.ops.ed.redo()
        assert bpy.context.object.mode == mode and contents() == back


def test_what_painting_changes_beside_the_band_is_told(banded, capfd):
    group = banded.vertex_groups["Cap"]
    keys(banded)[BANDS[0]].vertex_group = keys(banded)[BANDS[1]].vertex_group = "Cap"
    banded.modifiers.new("Shell", "SOLIDIFY").vertex_group = "Cap"
    before = weights(banded, "Cap")
    OPS.paint_mask(band=2)
    said = capfd.readouterr().out
    assert f"{BANDS[0]}, Shell use 'Cap' too, and change as it is painted" in said
    assert banded.vertex_groups.active == group and not own(banded)
    np.testing.assert_array_equal(weights(banded, "Cap"), before)
    OPS.paint_mask(band=2)
    keys(banded)[BANDS[2]].mute = True
    OPS.paint_mask(band=3)
    assert f"'{BANDS[2]}' is muted, so that its mask is not seen" in capfd.readouterr().out
    # Of its own it is free of the others.
    assert OPS.own_mask(band=2) == {"FINISHED"}
    np.testing.assert_array_equal(mask(banded), before)
    assert keys(banded)[BANDS[1]].vertex_group == MASKS[1] in own(banded)
    OPS.invert_mask(band=2)
    np.testing.assert_array_equal(weights(banded, "Cap"), before)
    np.testing.assert_array_equal(mask(banded), 1 - before)


def test_a_mask_whose_group_is_missing_is_made_anew(banded, capfd):
    keys(banded)[BANDS[1]].vertex_group = "Gone"
    with pytest.raises(RuntimeError, match="has no mask: there is no vertex group 'Gone'"):
        OPS.invert_mask(band=2)
    OPS.paint_mask(band=2)
    assert f"'Gone' that masked '{BANDS[1]}' is missing" in capfd.readouterr().out
    assert mask(banded) == pytest.approx(1)


def test_inverting_writes_the_own_mask_and_no_other_group(masked, capfd):
    before = mask(masked)
    OPS.invert_mask(band=2)
    np.testing.assert_array_equal(mask(masked), 1 - before)
    assert masked.vertex_groups.keys() == ["Cap", MASKS[1]]
    OPS.choose_mask(band=2, group="Cap")
    assert f"the vertex group '{MASKS[1]}' stays" in capfd.readouterr().out
    cap = weights(masked, "Cap")
    OPS.invert_mask(band=2)
    assert "'Cap' stays as it was" in capfd.readouterr().out
    np.testing.assert_array_equal(weights(masked, "Cap"), cap)
    np.testing.assert_array_equal(mask(masked), 1 - cap)
    # The first one was given up, so it is the user's, and not written over.
    np.testing.assert_array_equal(weights(masked, MASKS[1]), 1 - before)


def test_a_locked_mask_is_refused(masked):
    masked.vertex_groups[MASKS[1]].lock_weight = True
    before = contents()
    for refused in (OPS.invert_mask, OPS.blur_mask, OPS.fill_mask):
        with pytest.raises(RuntimeError, match=f"the vertex group '{MASKS[1]}' is locked"):
            refused(band=2)
    assert contents() == before
    OPS.remove_mask(band=2)
    assert masked.vertex_groups.keys() == ["Cap", MASKS[1]]


def test_masks_are_copied_to_one_band_or_to_all(masked):
    keys(masked)[BANDS[0]].vertex_group = "Cap"
    cap = weights(masked, "Cap")
    OPS.copy_mask(band=2, to=1)
    assert keys(masked)[BANDS[0]].vertex_group == MASKS[0] and not keys(masked)[3].vertex_group
    np.testing.assert_array_equal(weights(masked, "Cap"), cap)
    np.testing.assert_array_equal(mask(masked, 1), mask(masked))
    paint(masked, MASKS[0], range(99))
    OPS.copy_mask(band=2)
    for band in (1, 3):
        np.testing.assert_array_equal(mask(masked, band), mask(masked))
    assert masked.vertex_groups.keys() == ["Cap", MASKS[1], MASKS[0], MASKS[2]]
    paint(masked, MASKS[0], range(99), 0.5)
    assert set(mask(masked, 2)) == {0, 1}
    for to, why in ((2, "there is no other band"), (9, "it has no band 9, but 3 bands")):
        with pytest.raises(RuntimeError, match=why):
            OPS.copy_mask(band=2, to=to)


def test_filled_by_the_selection_in_edit_mode_and_combined(banded):
    up, right = heights(banded) > 0, np.array([v.co.x for v in banded.data.vertices]) > 0
    for combine, chosen, expected in (
        ("SUBTRACT", up, ~up),  # of a band that acted everywhere
        ("ADD", up & right, ~up | right),
        ("SUBTRACT", ~up & ~right, right),
        ("REPLACE", up, up),
    ):
        select(banded, chosen)
        bpy.ops.object.mode_set(mode="EDIT")
        assert OPS.fill_mask(band=2, combine=combine) == {"FINISHED"}
        assert banded.mode == "EDIT"
        bpy.ops.object.mode_set(mode="OBJECT")
        np.testing.assert_array_equal(mask(banded), expected)
    select(banded, np.zeros(len(up), dtype=bool))
    with pytest.raises(RuntimeError, match="no vertex is selected"):
        OPS.fill_mask(band=2)
    with pytest.raises(RuntimeError, match=f"'{BANDS[0]}' has no mask, so it acts everywhere"):
        OPS.fill_mask(band=1, source="GROUP", group="Cap", combine="ADD")
    with pytest.raises(RuntimeError, match="there is no vertex group 'Hat'"):
        OPS.fill_mask(band=1, source="GROUP", group="Hat")


def test_what_is_masked_in_sculpt_mode_is_left_out(banded):
    with pytest.raises(RuntimeError, match="nothing is masked in Sculpt Mode"):
        OPS.fill_mask(band=2, source="SCULPT_MASK")
    masked = np.linspace(0, 1, len(banded.data.vertices), dtype=np.float32)
    attribute = banded.data.attributes.new(".sculpt_mask", "FLOAT", "POINT")
    attribute.data.foreach_set("value", masked)
    bpy.ops.ed.undo_push(message="without it Sculpt Mode has no undo in the background")
    bpy.ops.object.mode_set(mode="SCULPT")
    OPS.fill_mask(band=2, source="SCULPT_MASK")
    assert banded.mode == "SCULPT"
    np.testing.assert_allclose(mask(banded), 1 - masked, atol=2e-6)


def test_removing_takes_the_group_that_was_made_and_no_other(masked, capfd):
    OPS.remove_mask(band=2)
    assert f"the vertex group '{MASKS[1]}' was removed" in capfd.readouterr().out
    assert masked.vertex_groups.keys() == ["Cap"] and not keys(masked)[BANDS[1]].vertex_group
    for use in ("band", "modifier"):
        OPS.paint_mask(band=2)
        OPS.paint_mask(band=2)
        if use == "band":
            OPS.choose_mask(band=3, group=MASKS[1])
        else:
            masked.modifiers.new("Shell", "SOLIDIFY").vertex_group = MASKS[1]
        OPS.remove_mask(band=2)
        assert f"the vertex group '{MASKS[1]}' stays" in capfd.readouterr().out
        if use == "band":
            OPS.remove_mask(band=3)
            assert MASKS[1] not in masked.vertex_groups
    OPS.choose_mask(band=2, group="Cap")
    OPS.remove_mask(band=2)
    assert "the vertex group 'Cap' stays" in capfd.readouterr().out
    with pytest.raises(RuntimeError, match=f"'{BANDS[1]}' has no mask"):
        OPS.remove_mask(band=2)


def by_nodes(obj) -> None:
    """Have an input of Geometry Nodes take the mask as an attribute."""
    tree = bpy.data.node_groups.new("Nodes", "GeometryNodeTree")
    socket = tree.interface.new_socket("Where", socket_type="NodeSocketFloat")
    modifier = obj.modifiers.new("Nodes", "NODES")
    modifier.node_group = tree
    if hasattr(modifier, "properties"):  # since Blender 5.2
        given = getattr(modifier.properties.inputs, socket.identifier)
        given.type, given.attribute_name = "ATTRIBUTE", MASKS[1]
    else:
        modifier[f"{socket.identifier}_attribute_name"] = MASKS[1]


def by_a_constraint(obj) -> None:
    """Have an object stay where the mask is."""
    other = bpy.data.objects.new("Hat", None)
    bpy.context.scene.collection.objects.link(other)
    constraint = other.constraints.new("COPY_LOCATION")
    constraint.target, constraint.subtarget = obj, MASKS[1]


def by_particles(obj) -> None:
    obj.modifiers.new("Hair", "PARTICLE_SYSTEM")
    obj.particle_systems[0].vertex_group_density = MASKS[1]


def by_cloth(obj) -> None:
    obj.modifiers.new("Cloth", "CLOTH").settings.vertex_group_mass = MASKS[1]


def by_deform(obj) -> None:
    constrain(obj, MASKS[1], "PIN")


@pytest.mark.parametrize("used", [by_nodes, by_a_constraint, by_particles, by_cloth, by_deform])
def test_what_uses_a_mask_beside_its_band_is_found(masked, used, capfd):
    before = mask(masked)
    used(masked)
    OPS.paint_mask(band=2)
    assert f"use '{MASKS[1]}' too, and change as it is painted" in capfd.readouterr().out
    OPS.paint_mask(band=2)
    OPS.invert_mask(band=2)
    np.testing.assert_array_equal(weights(masked, MASKS[1]), before)
    np.testing.assert_array_equal(mask(masked), 1 - before)
    OPS.remove_mask(band=2)
    assert masked.vertex_groups.keys() == ["Cap", MASKS[1]]
    bpy.data.batch_remove([*bpy.data.node_groups, *bpy.data.particles])


def test_a_group_of_yours_with_the_name_of_a_mask_is_not_touched(banded):
    banded.vertex_groups.new(name=MASKS[1]).add([3], 0.25, "REPLACE")
    OPS.paint_mask(band=2)
    assert keys(banded)[BANDS[1]].vertex_group == f"{MASKS[1]}.001"
    assert weights(banded, MASKS[1]).sum() == 0.25


def test_objects_that_share_the_mesh_share_the_mask(banded):
    twin = bpy.data.objects.new("Twin", banded.data)
    bpy.context.scene.collection.objects.link(twin)
    select(banded, heights(banded) > 0)
    OPS.fill_mask(band=2)
    np.testing.assert_array_equal(evaluated(twin), evaluated(banded))
    twin.modifiers.new("Shell", "SOLIDIFY").vertex_group = MASKS[1]
    OPS.remove_mask(band=2)
    assert MASKS[1] in twin.vertex_groups


def test_refusals_say_what_and_where(banded):
    before = contents()
    for arguments, why in (({"band": 4}, "it has no band 4, but 3 bands"),):
        for operator in (OPS.paint_mask, OPS.fill_mask, OPS.remove_mask, OPS.blur_mask):
            with pytest.raises(RuntimeError, match=why):
                operator(**arguments)
    with pytest.raises(RuntimeError, match=f"{banded.name}: '{BANDS[0]}' has no mask"):
        OPS.blur_mask(band=1)
    assert not differences(before, contents())
    banded.shape_key_remove(keys(banded)[BANDS[0]])
    with pytest.raises(RuntimeError, match=f"{banded.name}: band 1 was deleted"):
        OPS.paint_mask(band=1)
    assert banded.mode == "OBJECT"
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    for operator in (OPS.paint_mask, OPS.fill_mask):
        with pytest.raises(RuntimeError, match=f"{banded.name}: vertices or faces changed since"):
            operator(band=2)
        assert banded.mode == "EDIT"
    with pytest.raises(RuntimeError, match="Leave Edit Mode first"):
        OPS.invert_mask(band=2)
    bpy.ops.object.mode_set(mode="OBJECT")
    with pytest.raises(RuntimeError, match="Vertices or faces changed since"):
        OPS.paint_mask(band=2)
    ball("Bare")
    with pytest.raises(RuntimeError, match="has no bands"):
        OPS.paint_mask(band=2)
