"""Several decompositions of one object: listed, in sight, named, replaced with their look."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import bpy
import numpy as np
import pytest
from ball import bumpy_ball
from conftest import MODULE

STEPS = 13  # twelve components


def names(obj) -> list[str]:
    return [key.name for key in obj.data.shape_keys.key_blocks][1:]


def values(obj) -> list[float]:
    return [key.value for key in obj.data.shape_keys.key_blocks][1:]


def listed(obj) -> list[str]:
    return [record.name for record in obj.data.spectral_tv.decompositions]


def active(obj):
    kept = obj.data.spectral_tv
    return kept.decompositions[kept.active_decomposition]


def seen(obj) -> np.ndarray:
    shape = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    return np.array([vertex.co for vertex in shape.vertices])


def switch(name: str) -> None:
    assert bpy.ops.spectral_tv.switch_decomposition(name=name) == {"FINISHED"}


def decompose(**options) -> None:
    assert bpy.ops.spectral_tv.decompose(**{"steps": STEPS, **options}) == {"FINISHED"}


def told(capfd) -> str:
    return capfd.readouterr().out


def states(obj) -> dict[str, str]:
    """What is said of the decompositions that are not active and not at rest."""
    acting = import_module(f"{MODULE}.bands.acting")
    return {record.name: state.told() for record, state in acting.others_acting(obj)}


@pytest.fixture
def empty_file():
    """Without what tests before left, as some of it cannot be saved."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)


@pytest.fixture
def obj():
    """A bumpy ball with three bands of Shape Detail."""
    made = bumpy_ball()
    decompose(bands=3)
    bpy.ops.spectral_tv.widen_sliders()
    return made


@pytest.fixture
def keys(obj):
    return obj.data.shape_keys.key_blocks


@pytest.fixture
def both(obj):
    """The same with two bands of Limbs and Head, which are active."""
    decompose(method="M2", bands=2)
    return obj


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


def test_decomposing_again_keeps_the_look(obj, keys, capfd):
    """New settings, more bands: the same filter over the sizes, on the shape that was split."""
    for key, value in zip(keys[1:], (-1, 0.5, 2), strict=True):
        key.value, key.vertex_group = value, "Cap"
    before = seen(obj)
    told(capfd)
    decompose(bands=6, steps=25)
    assert "6 bands of Shape Detail take the place of those of 'Shape Detail'" in told(capfd)
    assert names(obj) == [f"Shape Detail Band {band}" for band in range(1, 7)] and listed(obj) == [
        "Shape Detail"
    ]
    assert values(obj) == pytest.approx([-1, -1, 0.5, 0.5, 2, 2])
    assert {key.vertex_group for key in keys[1:]} == {"Cap"}
    size = np.abs(before - seen_without(obj)).max()
    assert size > 0.05
    assert np.abs(seen(obj) - before).max() < 0.1 * size


def seen_without(obj) -> np.ndarray:
    return np.array([point.co for point in obj.data.shape_keys.reference_key.data])


@pytest.mark.parametrize("bands", [3, 4, 6])
def test_the_filter_over_sizes_stays_whatever_the_numbers_of_bands_and_steps(obj, keys, bands):
    """As H(t), which is constant between the edges of bands, up to one component of a flow."""
    for key, value in zip(keys[1:], (-1, 1, 3), strict=True):
        key.value = value
    old = [band.end for band in active(obj).bands]
    decompose(bands=bands, steps=33)
    starts_and_ends = [(band.start, band.end) for band in active(obj).bands]
    for key, (start, end) in zip(keys[1:], starts_and_ends, strict=True):
        middle = np.sqrt(max(start, end / 5) * end)
        among = [
            (-1, 1, 3)[np.searchsorted(old[:-1], t)] for t in (max(start, end / 5), end, middle)
        ]
        assert min(among) - 1e-6 <= key.value <= max(among) + 1e-6


def test_animation_drivers_and_names_of_the_user_go_over(obj, keys):
    keys["Shape Detail Band 1"].name = "Skin"
    keys["Skin"].value = -1
    keys["Skin"].keyframe_insert("value", frame=1)
    keys["Skin"].value = 2
    keys["Skin"].keyframe_insert("value", frame=11)
    keys["Shape Detail Band 3"].driver_add("value").driver.expression = "frame / 10"
    decompose(bands=3, steps=33, soft_edges=0)
    assert names(obj) == ["Skin", "Shape Detail Band 2", "Shape Detail Band 3"]
    for frame, expected in ((1, (-1, 0, 0.1)), (11, (2, 0, 1.1))):
        bpy.context.scene.frame_set(frame)
        assert values(obj) == pytest.approx(expected)


def test_what_no_new_band_has_the_sizes_of_is_told(obj, keys, capfd):
    keys["Shape Detail Band 1"].value = -1
    keys["Shape Detail Band 1"].keyframe_insert("value", frame=1)
    told(capfd)
    decompose(bands=3, steps=33, use_scales=True, finest=30, largest=60)
    said = told(capfd)
    assert "no new band has the sizes of 'Shape Detail Band 1', which was -1 and keyed" in said


def test_a_filter_is_of_sizes_on_the_object_however_it_is_scaled(obj, keys):
    keys["Shape Detail Band 1"].value = -1
    obj.scale = (3, 3, 3)
    bpy.context.view_layer.update()
    decompose(bands=3, steps=25)
    assert values(obj) == pytest.approx([-1, 0, 0])


def test_masks_go_over_unless_another_is_chosen(obj, keys, capfd):
    keys["Shape Detail Band 2"].vertex_group = "Cap"
    decompose(bands=3, steps=15)
    assert [key.vertex_group for key in keys[1:]] == ["", "Cap", ""]
    assert "its bands stay limited to Cap" in told(capfd)
    obj.vertex_groups.new(name="Other").add([1, 2, 3], 1, "ADD")
    decompose(bands=3, steps=15, vertex_group="Other")
    assert [key.vertex_group for key in keys[1:]] == ["Other"] * 3
    assert "limited to Other, no longer to Cap" in told(capfd)


def test_added_it_splits_what_is_shown(obj, keys):
    keys["Shape Detail Band 1"].value = -1
    once = seen(obj)
    decompose(bands=2, into="ADD")
    assert listed(obj) == ["Shape Detail", "Shape Detail 2"]
    np.testing.assert_allclose(seen(obj), once, atol=1e-6)
    assert names(obj)[3:] == ["Shape Detail 2 Band 1", "Shape Detail 2 Band 2"]


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


def make_old(obj) -> None:
    """Write the record as files had it before there were several."""
    values = import_module(f"{MODULE}.scene.property_values")
    kept = obj.data.spectral_tv
    record = values.values_of(kept.decompositions[0])
    for name in ("name", "mark", "scale"):
        del record[name]
    kept.property_unset("decompositions")
    values.set_values_of(kept.decomposition, record)


def test_files_of_before_open_and_work(empty_file, obj, tmp_path: Path):
    make_old(obj)
    # Appended or made by scripts, they are read as they are.
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=1)
    assert values(obj) == [-1, 0, 0] and listed(obj) == []
    path = str(tmp_path / "old.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False)
    bpy.ops.wm.open_mainfile(filepath=path)
    loaded = bpy.data.objects["Ball"]
    assert listed(loaded) == ["Shape Detail"] and not loaded.data.spectral_tv.decomposition.bands
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=2, last=2)
    assert values(loaded) == [0, -1, 0]
    loaded.data.spectral_tv.decompositions[0].name = "Skin"
    decompose(bands=3, steps=25)
    assert names(loaded) == [f"Skin Band {band}" for band in (1, 2, 3)]
    assert values(loaded) == pytest.approx([0, -1, 0])


def test_an_old_record_is_listed_when_another_is_added(obj, keys):
    make_old(obj)
    decompose(method="M2", bands=2)
    assert listed(obj) == ["Shape Detail", "Limbs and Head"]
    switch("Shape Detail")
    bpy.ops.spectral_tv.cut(bands=2)
    assert names(obj) == [
        "Shape Detail Band 1",
        "Shape Detail Band 2",
        "Limbs and Head Band 1",
        "Limbs and Head Band 2",
    ]


def test_bands_of_vertices_that_are_gone_stay_beside_the_new_ones(obj, keys, capfd):
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    bpy.ops.object.mode_set(mode="OBJECT")
    told(capfd)
    decompose(bands=2)
    assert "'Shape Detail' is of other vertices, so it stays beside the new one" in told(capfd)
    assert listed(obj) == ["Shape Detail", "Shape Detail 2"]
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=2)
    assert values(obj) == [0, 0, 0, -1, -1]


def test_a_caricature_is_not_piled_on_the_last_one(obj, keys):
    how = {"bands": 3, "steps": STEPS, "first": 2, "last": 3, "smooth": 1}
    for amount in (2, 1):
        bpy.ops.spectral_tv.caricature(amount=amount, **how)
    assert listed(obj) == ["Shape Detail"]
    again = seen(obj)
    bpy.ops.spectral_tv.remove_decomposition()
    bpy.ops.spectral_tv.caricature(amount=1, **how)
    np.testing.assert_allclose(seen(obj), again, atol=1e-5)
