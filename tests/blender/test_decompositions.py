"""Several decompositions of one object: listed, in sight, set and removed each by itself."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import banded_ball
import bpy
import numpy as np
import pytest
from banded_ball import active, decompose, listed, names, seen, switch, told, values
from conftest import MODULE

obj, keys, both = banded_ball.obj, banded_ball.keys, banded_ball.both
empty_file = banded_ball.empty_file


def states(obj) -> dict[str, str]:
    """What is said of the decompositions that are not active and not at rest."""
    acting = import_module(f"{MODULE}.bands.acting")
    return {record.name: state.told() for record, state in acting.others_acting(obj)}


def test_another_method_is_added_and_each_is_set_by_itself(both, keys):
    assert (
        listed(both) == ["Shape Detail", "Limbs and Head"] and active(both).name == "Limbs and Head"
    )
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=1)
    assert values(both) == [0, 0, 0, -1, 0]
    switch("Shape Detail")
    bpy.ops.spectral_tv.filter(preset="EXAGGERATE", first=2, last=3, amount=2)
    assert values(both) == [0, 2, 2, -1, 0]
    bpy.ops.spectral_tv.solo(band=2)
    assert [key.mute for key in keys] == [False, True, False, True, False, False]
    bpy.ops.spectral_tv.cut(bands=4)
    assert names(both) == [
        *(f"Shape Detail Band {band}" for band in (1, 2, 3, 4)),
        "Limbs and Head Band 1",
        "Limbs and Head Band 2",
    ]
    assert keys["Limbs and Head Band 1"].value == -1
    with pytest.raises(RuntimeError, match="no decomposition 'M7'"):
        bpy.ops.spectral_tv.switch_decomposition(name="M7")


def test_what_acts_unseen_is_told(both, keys):
    assert states(both) == {}
    keys["Shape Detail Band 2"].value = -1
    assert states(both) == {"Shape Detail": "acts: Band 2 −1"}
    keys["Shape Detail Band 2"].mute = True
    assert states(both) == {"Shape Detail": "is muted: Band 2"}
    keys["Shape Detail Band 2"].mute, keys["Shape Detail Band 2"].value = False, 0
    assert states(both) == {}
    switch("Shape Detail")
    bpy.ops.spectral_tv.solo(band=3)
    switch("Limbs and Head")
    assert states(both) == {"Shape Detail": "has band 3 soloed"}


def test_reset_means_all_and_can_mean_one(both, keys):
    for key in keys[1:]:
        key.value = 1
    bpy.ops.spectral_tv.filter(preset="RESET", every=False)
    assert values(both) == [1, 1, 1, 0, 0]
    bpy.ops.spectral_tv.filter(preset="RESET")
    assert not any(values(both))


def test_removing_one_leaves_the_active_key_of_each_object(both, keys):
    """Sculpt Mode would change another one."""
    both.shape_key_add(name="Smile", from_mix=False)
    twin = bpy.data.objects.new("Twin", both.data)
    both.active_shape_key_index = keys.find("Limbs and Head Band 2")
    twin.active_shape_key_index = keys.find("Smile")
    bpy.ops.spectral_tv.remove_decomposition(name="Shape Detail")
    assert both.active_shape_key.name == "Limbs and Head Band 2"
    assert twin.active_shape_key.name == "Smile"


def test_removing_one_leaves_all_else(both, keys, capfd):
    smile = both.shape_key_add(name="Smile", from_mix=False)
    smile.driver_add("value").driver.expression = "0.5"
    driver = both.driver_add("location", 0).driver
    variable = driver.variables.new()
    variable.targets[0].id = both
    variable.targets[0].data_path = 'data.shape_keys.key_blocks["Shape Detail Band 2"].value'
    keys["Shape Detail Band 3"].keyframe_insert("value", frame=1)
    keys["Shape Detail Band 1"].value = 2
    keys["Limbs and Head Band 1"].keyframe_insert("value", frame=1)
    keys["Shape Detail Band 2"].name = "Wrinkles"
    told(capfd)
    assert bpy.ops.spectral_tv.remove_decomposition(name="Shape Detail") == {"FINISHED"}
    assert names(both) == ["Limbs and Head Band 1", "Limbs and Head Band 2", "Smile"]
    assert listed(both) == ["Limbs and Head"] and active(both).name == "Limbs and Head"
    said = told(capfd)
    assert (
        "removed the decomposition 'Shape Detail' and its shape keys Shape Detail Band 1, "
        "Wrinkles, Shape Detail Band 3" in said
    )
    assert "the shape changes, as these bands were not at 0: Shape Detail Band 1" in said
    assert "the animation of these bands went too: Shape Detail Band 3" in said
    assert "drivers of Ball read these bands" in said
    animated = import_module(f"{MODULE}.scene.channels").curves_and_drivers(both.data.shape_keys)
    paths = {curve.data_path for curve in animated}
    assert paths == {'key_blocks["Smile"].value', 'key_blocks["Limbs and Head Band 1"].value'}
    bpy.ops.spectral_tv.remove_decomposition()
    assert names(both) == ["Smile"] and not bpy.ops.spectral_tv.filter.poll()


def test_two_alike_are_two(obj, keys):
    """With the same contents; a new name of one does not have it taken for the other."""
    decompose(bands=3, into="ADD", shape="BASIS")
    keys["Shape Detail Band 1"].name = "Fine"
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=1)
    assert keys["Shape Detail 2 Band 1"].value == -1 and keys["Fine"].value == 0
    switch("Shape Detail")
    bpy.ops.spectral_tv.filter(preset="EXAGGERATE", first=1, last=1, amount=3)
    assert keys["Shape Detail 2 Band 1"].value == -1 and keys["Fine"].value == 3


def test_the_mix_that_is_seen_is_that_of_all(both, keys, capfd):
    """Folds are counted of it, Bake Safe bakes it, and Apply Look makes it the shape."""
    guard = import_module(f"{MODULE}.bands.live_guard")
    for key in keys[1:4]:
        key.value = 10
    bpy.context.view_layer.update()
    assert guard.count(both).icon == "ERROR"  # bands of Shape Detail fold, Limbs and Head is active
    for key in keys[1:]:
        key.value = 0.5
    before = seen(both)
    bpy.ops.spectral_tv.bake_safe(stretch=100)
    bpy.ops.spectral_tv.filter(preset="RESET")
    keys["Safe"].value = 1
    np.testing.assert_allclose(seen(both), before, atol=1e-5)
    keys["Safe"].value = 0
    for key in keys[1:6]:
        key.value = 0.5
    assert bpy.ops.spectral_tv.apply_look() == {"FINISHED"}
    assert names(both) == ["Safe"] and listed(both) == []
    np.testing.assert_allclose(seen(both), before, atol=1e-5)


def test_a_filter_goes_to_the_decomposition_that_is_alike(both):
    twin = bpy.data.objects.new("Twin", both.data.copy())
    bpy.context.collection.objects.link(twin)
    switch("Shape Detail")
    both.data.shape_keys.key_blocks["Shape Detail Band 2"].value = 2
    twin.select_set(True)
    assert active(twin).name == "Limbs and Head"
    assert bpy.ops.spectral_tv.copy_filter() == {"FINISHED"}
    assert values(twin) == [0, 2, 0, 0, 0]


def test_modifiers_are_applied_to_all(both):
    both.modifiers.new("Subdivision", "SUBSURF")
    assert bpy.ops.spectral_tv.apply_modifier() == {"FINISHED"}
    for name, expected in (
        ("Shape Detail", [-1, 0, 0, 0, 0]),
        ("Limbs and Head", [-1, 0, 0, -1, 0]),
    ):
        switch(name)
        bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=1)
        assert values(both) == expected


def test_a_file_keeps_them_all(empty_file, both, tmp_path: Path):
    both.data.spectral_tv.decompositions["Shape Detail"].name = "Skin"
    path = str(tmp_path / "two.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False)
    bpy.ops.wm.open_mainfile(filepath=path)
    loaded = bpy.data.objects["Ball"]
    assert listed(loaded) == ["Skin", "Limbs and Head"] and active(loaded).name == "Limbs and Head"
    switch("Skin")
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=3)
    assert values(loaded) == [-1, -1, -1, 0, 0]
