"""Bands as attributes: the same shapes as shape keys give, in every operator of the panel."""

from __future__ import annotations

from importlib import import_module

import bpy
import numpy as np
import pytest
from ball import ball, bumpy_ball
from command_line_files import exportable
from conftest import MODULE
from deform_scene import evaluated, group
from rigged_body import FRAMES, bent_rig, poses

OPS = bpy.ops.spectral_tv
SMALL = {"bands": 3, "steps": 8}
VALUES = (1.5, -0.4, 0.7)
RECORDS = import_module(f"{MODULE}.scene.records")
MIX = import_module(f"{MODULE}.scene.mix")
INPUTS = import_module(f"{MODULE}.scene.node_inputs")


def bands(obj):
    return RECORDS.bands_of(obj)


def dial(obj, values=VALUES) -> None:
    for band, value in zip(bands(obj), values, strict=True):
        band.value = value


def split(kind: str, make=bumpy_ball, **more):
    """An object with dialled bands of a kind."""
    obj = make()
    assert OPS.decompose(bands_as=kind, **{**SMALL, **more}) == {"FINISHED"}
    dial(obj)
    return obj


@pytest.fixture
def obj():
    return split("ATTRIBUTES")


@pytest.fixture(autouse=True)
def _no_node_groups():
    yield
    bpy.data.batch_remove([*bpy.data.objects, *bpy.data.node_groups])


def size(obj) -> float:
    return float(np.linalg.norm(obj.dimensions))


def names_of(modifier) -> list[str]:
    return [
        each.name for each in modifier.node_group.interface.items_tree if each.in_out == "INPUT"
    ]


FILTERS = {
    "dialled": lambda: None,
    "low pass": lambda: OPS.filter(preset="LOW_PASS", first=2, last=3),
    "exaggerated": lambda: OPS.filter(preset="EXAGGERATE", first=1, last=2, amount=3),
    "solo": lambda: OPS.solo(band=2),
    "masked": lambda: OPS.fill_mask(band=2, source="GROUP", group="Cap"),
    "inverted": lambda: (
        OPS.fill_mask(band=2, source="GROUP", group="Cap"), OPS.invert_mask(band=2)
    ),
    "blurred": lambda: (
        OPS.fill_mask(band=2, source="GROUP", group="Cap"), OPS.blur_mask(band=2, radius=10)
    ),
    "limited": lambda: OPS.limit_movement(limit=0.05),
    "copied": lambda: (
        OPS.fill_mask(band=2, source="GROUP", group="Cap"), OPS.copy_mask(band=2)
    ),
    "cut again": lambda: OPS.cut(bands=2),
    "limbs kept": lambda: OPS.cut(bands=3, keep_limbs=0.5),
    "replaced": lambda: OPS.decompose(
        bands=4, steps=8, bands_as=RECORDS.record_of(bpy.context.object).kept
    ),
    "added": lambda: OPS.decompose(
        method="M2", bands_as=RECORDS.record_of(bpy.context.object).kept, **SMALL
    ),
    "reset": lambda: OPS.filter(preset="RESET"),
}  # fmt: skip


@pytest.mark.parametrize("name", FILTERS)
def test_the_same_filter_gives_the_same_shape(name):
    shapes = []
    for kind in ("KEYS", "ATTRIBUTES"):
        obj = split(kind)
        FILTERS[name]()
        assert RECORDS.record_of(obj).kept == kind
        shapes.append(evaluated(obj))
        # What the guard, the limit and others reckon with is what is seen.
        np.testing.assert_allclose(MIX.shown(obj), shapes[-1], rtol=0, atol=1e-6 * size(obj))
        bpy.data.batch_remove([obj])
    np.testing.assert_allclose(*shapes, rtol=0, atol=1e-6 * np.linalg.norm(np.ptp(shapes[0], 0)))


def test_a_modifier_has_a_labelled_gain_mask_and_mute_for_each_band(obj):
    (modifier,) = obj.modifiers
    labels = [
        label
        for band in bands(obj)
        for label in (band.name, f"{band.name} Mask", f"{band.name} Mute")
    ]
    assert names_of(modifier)[1:] == labels
    assert modifier.name == "Shape Detail" and obj.data.shape_keys is None
    values = [INPUTS.value_of(modifier, each.gain) for each in bands(obj)]
    np.testing.assert_allclose(values, VALUES, atol=1e-6)


def test_node_groups_are_shared_by_as_many_bands(obj):
    other = split("ATTRIBUTES", lambda: ball("Other"))
    inner = [
        node.node_tree
        for each in (obj, other)
        for node in each.modifiers[0].node_group.nodes
        if node.type == "GROUP"
    ]
    assert inner[0] == inner[1] and inner[0].name == "Spectral TV 3 Bands"


def test_labels_follow_the_name_of_the_decomposition(obj):
    before = evaluated(obj)
    obj.data.spectral_tv.decompositions[0].name = "Skin"
    assert [band.name for band in bands(obj)] == [f"Skin Band {band}" for band in (1, 2, 3)]
    assert obj.modifiers[0].name == "Skin" and "Skin Band 2" in names_of(obj.modifiers[0])
    np.testing.assert_array_equal(evaluated(obj), before)


def test_labels_follow_an_attribute_that_is_renamed(obj):
    before = evaluated(obj)
    obj.data.attributes["Shape Detail Band 2"].name = "Pores"
    # Blender calls it where the name is typed in its window.
    import_module(f"{MODULE}.bands.attribute_names").follow()
    assert bands(obj)[1].name == "Pores" and "Pores Mask" in names_of(obj.modifiers[0])
    np.testing.assert_array_equal(evaluated(obj), before)


def test_an_operator_follows_an_attribute_that_a_script_renamed(obj):
    before = evaluated(obj)
    obj.data.attributes["Shape Detail Band 2"].name = "Pores"
    OPS.widen_sliders()
    assert bands(obj)[1].name == "Pores" and bands(obj)[1].slider_max == 10
    np.testing.assert_array_equal(evaluated(obj), before)


def test_modifiers_ahead_of_the_bands_are_known(obj):
    ahead = import_module(f"{MODULE}.scene.modifiers").ahead_of_bands
    obj.modifiers.new("Subdivision", "SUBSURF")
    assert ahead(obj) == []
    obj.modifiers.move(1, 0)
    assert ahead(obj) == ["Subdivision"]


def test_a_copy_with_a_mesh_of_its_own_keeps_its_labels(obj):
    copy = obj.copy()
    copy.data = obj.data.copy()
    bpy.context.scene.collection.objects.link(copy)
    before = evaluated(copy)
    obj.data.spectral_tv.decompositions[0].name = "Skin"
    OPS.cut(bands=2)
    assert "Shape Detail Band 3" in names_of(copy.modifiers[0])
    np.testing.assert_array_equal(evaluated(copy), before)


def test_an_instance_has_gains_of_its_own_and_bands_are_not_made_anew(obj):
    twin = obj.copy()
    bpy.context.scene.collection.objects.link(twin)
    before = evaluated(obj)
    dial(twin, (0, 0, 0))
    np.testing.assert_array_equal(evaluated(obj), before)
    assert np.abs(evaluated(twin) - before).max() > 0.01
    for operator in ("cut", "apply_look", "convert_bands", "remove_decomposition"):
        with pytest.raises(RuntimeError, match="2 objects share this mesh"):
            getattr(OPS, operator)()
    assert OPS.filter(preset="RESET") == {"FINISHED"}
    np.testing.assert_allclose(evaluated(obj), evaluated(twin), atol=1e-7)


def test_values_are_keyframed_and_driven(obj):
    assert OPS.keyframe() == {"FINISHED"}
    bpy.context.scene.frame_set(11)
    dial(obj, (0, 0, 0))
    assert OPS.keyframe() == {"FINISHED"}
    bpy.context.scene.frame_set(1)
    np.testing.assert_allclose([band.value for band in bands(obj)], VALUES, atol=1e-6)
    first = bands(obj)[0]
    place = RECORDS.keeping_of(RECORDS.record_of(obj))
    assert place.animation_of(first, "value") == "keyed"
    obj.animation_data_clear()
    obj.driver_add(place.path(first, "value")).driver.expression = "frame / 10"
    bpy.context.scene.frame_set(5)
    assert first.value == pytest.approx(0.5)
    assert place.animation_of(first, "value") == "driven"
    bpy.context.scene.frame_set(1)


def test_bands_act_at_rest_before_an_armature():
    found = {}
    for kind in ("KEYS", "ATTRIBUTES"):
        obj = bumpy_ball()
        obj.modifiers.new("Armature", "ARMATURE").object = bent_rig(obj)
        obj.select_set(True)
        OPS.decompose(bands_as=kind, **SMALL)
        dial(obj)
        found[kind] = poses(obj)
    assert [each.type for each in obj.modifiers] == ["NODES", "ARMATURE"]
    for one, other in zip(*found.values(), strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-6 * size(obj))
    assert len(found["KEYS"]) == len(FRAMES)


def test_bands_are_added_to_what_shape_keys_show():
    obj = bumpy_ball()
    obj.shape_key_add(name="Basis")
    wide = obj.shape_key_add(name="Wide")
    for point in wide.points:
        point.co.x *= 1.5
    wide.value = 1
    OPS.decompose(bands_as="ATTRIBUTES", shape="BASIS", **SMALL)
    at_rest = evaluated(obj)
    dial(obj)
    moved = sum(value * band.displacement() for value, band in zip(VALUES, bands(obj), strict=True))
    np.testing.assert_allclose(evaluated(obj), at_rest + moved, rtol=0, atol=1e-6)
    assert list(obj.data.shape_keys.key_blocks.keys()) == ["Basis", "Wide"]


@pytest.mark.parametrize("change", ["subdivide", "remesh"])
def test_attributes_are_carried_along_and_dialled(obj, change):
    dial(obj, (0, 0, 0))
    if change == "subdivide":
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.mesh.subdivide()
        bpy.ops.object.mode_set(mode="OBJECT")
    else:
        obj.data.remesh_voxel_size = 0.1
        name = "use_remesh_preserve_attributes"
        if not hasattr(obj.data, name):
            name = "use_remesh_preserve_vertex_colors"
        setattr(obj.data, name, True)
        bpy.ops.object.voxel_remesh()
    count = len(obj.data.vertices)
    assert count != 642
    rest = evaluated(obj)
    assert OPS.filter(preset="LOW_PASS", first=2, last=2) == {"FINISHED"}
    bands(obj)[2].value = 0.5
    moved = sum(band.value * band.displacement() for band in bands(obj))
    np.testing.assert_allclose(evaluated(obj), rest + moved, rtol=0, atol=1e-6)
    assert np.abs(moved).max() > 0.001
    assert not OPS.cut.poll()


def test_modifiers_after_the_bands_can_be_applied(obj):
    """Blender itself does, as there are no shape keys."""
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.subdivision_type = "SIMPLE"
    dial(obj, (0, 0, 0))
    obj.modifiers.move(1, 0)
    bpy.ops.object.modifier_apply(modifier="Subdivision")
    rest = evaluated(obj)
    dial(obj)
    moved = sum(band.value * band.displacement() for band in bands(obj))
    np.testing.assert_allclose(evaluated(obj), rest + moved, rtol=0, atol=1e-6)


def test_blenders_apply_makes_the_look_the_shape(obj):
    look = evaluated(obj)
    bpy.ops.object.modifier_apply(modifier=obj.modifiers[0].name)
    np.testing.assert_array_equal(evaluated(obj), look)
    assert RECORDS.record_of(obj) is None and "Shape Detail Band 1" in obj.data.attributes


def test_an_applied_look_is_what_was_seen(obj):
    look = evaluated(obj)
    assert OPS.apply_look() == {"FINISHED"}
    np.testing.assert_allclose(evaluated(obj), look, rtol=0, atol=1e-6)
    assert not obj.modifiers and not [each for each in obj.data.attributes if "Band" in each.name]
    assert not bpy.data.node_groups


def test_a_baked_mix_is_what_is_seen(obj):
    look = evaluated(obj)
    OPS.bake()
    points = [point.co for point in obj.data.shape_keys.key_blocks["Filtered"].points]
    np.testing.assert_allclose(np.array(points), look, rtol=0, atol=1e-6)
    np.testing.assert_allclose(evaluated(obj), look, rtol=0, atol=1e-6)


def test_a_mask_may_be_any_attribute_or_a_number(obj):
    dial(obj, (1, 0, 0))
    (modifier,), first = obj.modifiers, bands(obj)[0]
    rest, moved = evaluated(obj) - first.displacement(), first.displacement()
    wear = np.linspace(0, 1, len(moved), dtype=np.float32)
    obj.data.attributes.new("Wear", "FLOAT", "POINT").data.foreach_set("value", wear)
    INPUTS.set_attribute(modifier, first.entry.mask, "Wear")
    wanted = rest + wear[:, np.newaxis] * moved
    for found in (evaluated(obj), MIX.shown(obj)):
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-6)
    INPUTS.set_attribute(modifier, first.entry.mask, "")
    INPUTS.set_value(modifier, first.entry.mask, 0.25)
    for found in (evaluated(obj), MIX.shown(obj)):
        np.testing.assert_allclose(found, rest + 0.25 * moved, rtol=0, atol=1e-6)
    group(obj, "Nowhere", [])
    INPUTS.set_attribute(modifier, first.entry.mask, "missing")
    for found in (evaluated(obj), MIX.shown(obj)):
        np.testing.assert_allclose(found, rest, rtol=0, atol=1e-6)


@pytest.mark.parametrize(
    ("reason", "hinder"),
    [
        ("has to be the first", lambda obj: obj.modifiers.new("Multires", "MULTIRES")),
        (
            "2 objects share",
            lambda obj: bpy.context.scene.collection.objects.link(obj.copy()),
        ),
        (
            "bends the object as its parent",
            lambda obj: (
                setattr(obj, "parent", bent_rig(obj)), setattr(obj, "parent_type", "ARMATURE")
            ),
        ),
    ],
)  # fmt: skip
def test_where_bands_cannot_be_attributes_that_is_said(reason, hinder):
    obj = bumpy_ball()
    obj.select_set(True)
    hinder(obj)
    with pytest.raises(RuntimeError, match=reason):
        OPS.decompose(bands_as="ATTRIBUTES", **SMALL)
    assert RECORDS.record_of(obj) is None and "Shape Detail Band 1" not in obj.data.attributes


def test_bands_of_a_look_with_modifiers_applied_are_attributes_too():
    obj = bumpy_ball()
    obj.select_set(True)
    obj.modifiers.new("Subdivision", "SUBSURF")
    OPS.decompose(bands_as="ATTRIBUTES", shape="APPLIED", **SMALL)
    new = bpy.context.object
    assert new != obj and [each.type for each in new.modifiers] == ["NODES"]


def test_a_decomposition_that_is_replaced_becomes_what_is_asked_for(obj):
    before = evaluated(obj)
    OPS.decompose(bands_as="KEYS", **SMALL)
    assert not obj.modifiers and len(obj.data.shape_keys.key_blocks) == 4
    np.testing.assert_allclose(evaluated(obj), before, rtol=0, atol=1e-6)


def test_heights_are_how_far_bands_move_the_surface_outwards():
    obj = split("ATTRIBUTES", heights=True)
    moves = [band.displacement() for band in bands(obj)]
    base = np.array([v.co for v in obj.data.vertices]) - sum(moves)
    faces = np.array([each.vertices for each in obj.data.polygons])
    across = np.cross(base[faces[:, 1]] - base[faces[:, 0]], base[faces[:, 2]] - base[faces[:, 0]])
    normals = np.zeros_like(base)
    for corner in faces.T:
        np.add.at(normals, corner, across)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    for band, moved in zip(bands(obj), moves, strict=True):
        found = np.empty(len(base), dtype=np.float32)
        obj.data.attributes[f"{band.name} Height"].data.foreach_get("value", found)
        np.testing.assert_allclose(found, (moved * normals).sum(axis=1), rtol=0, atol=1e-5)
    OPS.cut(bands=2)
    names = [each.name for each in obj.data.attributes if "Height" in each.name]
    assert names == ["Shape Detail Band 1 Height", "Shape Detail Band 2 Height"]


def test_heights_of_shape_keys_are_the_same():
    found = []
    for kind in ("KEYS", "ATTRIBUTES"):
        obj = split(kind)
        assert OPS.write_heights() == {"FINISHED"}
        values = np.empty(len(obj.data.vertices), dtype=np.float32)
        obj.data.attributes["Shape Detail Band 3 Height"].data.foreach_get("value", values)
        found.append(values)
    np.testing.assert_allclose(*found, rtol=0, atol=1e-6)


@pytest.mark.skipif(".usda" not in exportable(), reason="this Blender is built without .usda")
def test_usd_has_attributes_along_with_what_is_seen(obj, tmp_path):
    path, look = str(tmp_path / "it.usd"), evaluated(obj)
    bpy.ops.wm.usd_export(filepath=path)
    bpy.data.batch_remove([obj])
    bpy.ops.wm.usd_import(filepath=path)
    (copy,) = [each for each in bpy.data.objects if each.type == "MESH"]
    np.testing.assert_allclose(evaluated(copy), look, rtol=0, atol=1e-6)
    names = [each.name for each in copy.data.attributes]
    assert {f"Shape_Detail_Band_{band}" for band in (1, 2, 3)} <= {*names}


def test_values_beyond_the_ends_of_a_slider_act_as_these_do():
    for kind in ("KEYS", "ATTRIBUTES"):
        obj = split(kind)
        place, first = RECORDS.keeping_of(RECORDS.record_of(obj)), bands(obj)[0]
        path, owner = place.path(first, "value"), place.block(obj)
        owner.driver_add(path).driver.expression = "7"
        bpy.context.view_layer.update()
        assert bands(obj)[0].value == 2
        np.testing.assert_allclose(evaluated(obj), MIX.shown(obj), rtol=0, atol=1e-6)
