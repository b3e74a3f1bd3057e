"""Names of decompositions: bands follow them, and no two things share one."""

from __future__ import annotations

import banded_ball
import bpy
from banded_ball import decompose, listed, names, switch, values

obj, keys, both = banded_ball.obj, banded_ball.keys, banded_ball.both


def test_four_in_a_row_have_names_that_tell_them_apart(obj, keys):
    for method in ("M3", "M1", "M2", "M1"):
        decompose(method=method, bands=2, steps=8)
    decompose(bands=2, steps=8, vertex_group="Cap", into="ADD")
    assert listed(obj) == [
        "Shape Detail",
        "Edge-Keeping Detail",
        "Shape Detail 2",
        "Limbs and Head",
        "Shape Detail 3",
        "Shape Detail Cap",
    ]
    assert not [name for name in names(obj) if ".0" in name]
    assert len(set(names(obj))) == 3 + 5 * 2


def test_bands_are_numbered_from_the_finest_whatever_became_of_others(obj, keys):
    """Also where a new band has just what an old one of another number had."""
    for how in ({"bands": 5, "steps": 16}, {"bands": 7, "steps": 24}, {"bands": 4, "steps": 16}):
        decompose(**how)
        assert names(obj) == [f"Shape Detail Band {band}" for band in range(1, how["bands"] + 1)]
        for count in (6, 3, 8):
            bpy.ops.spectral_tv.cut(bands=count)
            assert names(obj) == [f"Shape Detail Band {band}" for band in range(1, count + 1)]


def test_bands_follow_the_name_of_their_decomposition(both, keys):
    """But for those that were renamed; what animates and reads them goes on."""
    keys["Shape Detail Band 2"].name = "Wrinkles"
    for name, value in (("Shape Detail Band 1", 3), ("Wrinkles", 2)):
        keys[name].value = value
        keys[name].keyframe_insert("value", frame=1)
    driver = both.driver_add("location", 0).driver
    driver.expression = "v"
    variable = driver.variables.new()
    variable.name = "v"
    variable.targets[0].id = both
    variable.targets[0].data_path = 'data.shape_keys.key_blocks["Shape Detail Band 1"].value'
    both.data.spectral_tv.decompositions["Shape Detail"].name = "Skin"
    assert names(both)[:3] == ["Skin Band 1", "Wrinkles", "Skin Band 3"]
    keys["Skin Band 1"].value = keys["Wrinkles"].value = 0
    bpy.context.scene.frame_set(2)
    bpy.context.scene.frame_set(1)
    assert (keys["Skin Band 1"].value, keys["Wrinkles"].value) == (3, 2)
    assert both.evaluated_get(bpy.context.evaluated_depsgraph_get()).location.x == 3
    switch("Skin")
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=3)
    assert values(both) == [-1, -1, -1, 0, 0]
    bpy.ops.spectral_tv.cut(bands=2)
    assert "Skin Band 2" in names(both)


def test_an_action_that_others_play_keeps_their_curves(obj, keys):
    keys["Shape Detail Band 1"].value = 3
    keys["Shape Detail Band 1"].keyframe_insert("value", frame=1)
    twin = obj.copy()
    twin.data = obj.data.copy()
    bpy.context.collection.objects.link(twin)
    own, others = obj.data.shape_keys.animation_data, twin.data.shape_keys.animation_data
    others.action = own.action
    if hasattr(own, "action_slot"):
        others.action_slot = own.action_slot
    obj.data.spectral_tv.decompositions[0].name = "Skin"
    for each, name in ((obj, "Skin Band 1"), (twin, "Shape Detail Band 1")):
        each.data.shape_keys.key_blocks[name].value = 0
    bpy.context.scene.frame_set(2)
    bpy.context.scene.frame_set(1)
    assert (
        keys["Skin Band 1"].value
        == twin.data.shape_keys.key_blocks["Shape Detail Band 1"].value
        == 3
    )


def test_names_are_nobody_elses(both, keys):
    first, second = both.data.spectral_tv.decompositions
    second.name = "Shape Detail"
    assert second.name == "Shape Detail 2" and "Shape Detail 2 Band 1" in keys
    both.shape_key_add(name="Skin Band 1", from_mix=False)
    first.name = "Skin"
    assert first.name == "Skin 2"
    first.name = "  "
    assert first.name == "Bands" and names(both)[0] == "Bands Band 1"
    first.name = "ä" * 80
    assert all(len(name.encode()) <= 63 for name in names(both))
    assert len(set(names(both))) == 6
