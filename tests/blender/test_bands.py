"""What the sidebar does with bands, by its operators."""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module
from itertools import groupby
from pathlib import Path

import bpy
import numpy as np
import pytest
import spectral_tv
from spectral_tv.bands import gains
from spectral_tv.bands.settings import Settings

EXTENSION = "bl_ext.user_default.spectral_tv"


def values(obj) -> list[float]:
    blocks = obj.data.shape_keys.key_blocks
    return [key.value for key in blocks if "Band" in key.name]


def shape(key) -> np.ndarray:
    flat = np.empty(3 * len(key.data), dtype=np.float32)
    key.data.foreach_get("co", flat)
    return flat


def activate(obj) -> None:
    for other in bpy.context.selected_objects:
        other.select_set(False)
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)


@pytest.fixture
def banded(monkey):
    bpy.ops.spectral_tv.decompose(bands=4, steps=12)
    return monkey


@pytest.mark.parametrize(
    ("preset", "expected"),
    [
        ("LOW_PASS", [-1, 0, 0, 0]),
        ("HIGH_PASS", [0, 0, 0, -1]),
        ("BAND_PASS", [-1, 0, 0, -1]),
        ("BAND_STOP", [0, -1, -1, 0]),
        ("EXAGGERATE", [0, 1.5, 1.5, 0]),
        ("RESET", [0, 0, 0, 0]),
    ],
)
def test_presets(banded, preset, expected):
    banded.data.shape_keys.key_blocks["Shape Detail Band 1"].value = 0.3
    bpy.ops.spectral_tv.filter(preset=preset, first=2, last=3, amount=1.5)
    assert values(banded) == expected
    bpy.ops.spectral_tv.filter(preset=preset, first=3, last=2, amount=1.5)
    assert values(banded) == expected


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({"preset": "LOW_PASS", "first": 1}, "no band is finer than band 1"),
        ({"preset": "HIGH_PASS", "last": 9}, "no band is coarser than band 4"),
        ({"preset": "BAND_PASS", "first": 1, "last": 4}, "all bands are chosen"),
        ({"preset": "EXAGGERATE", "amount": 0}, "the amount is 0"),
    ],
)
def test_a_preset_that_changes_nothing_says_so(banded, capfd, options, reason):
    assert bpy.ops.spectral_tv.filter(**options) == {"FINISHED"}
    assert f"changes nothing: {reason}" in capfd.readouterr().out
    assert values(banded) == [0, 0, 0, 0]


def test_what_keeps_a_filter_from_being_seen_is_told(banded, capfd):
    keys = banded.data.shape_keys.key_blocks
    keys["Shape Detail Band 1"].mute = True
    keys["Shape Detail Band 2"].driver_add("value").driver.expression = "1"
    keys["Shape Detail Band 3"].keyframe_insert("value", frame=1)
    keys["Shape Detail Band 4"].slider_max = 1.5
    banded.show_only_shape_key = True
    bpy.ops.spectral_tv.filter(preset="EXAGGERATE", first=1, last=4, amount=3)
    said = capfd.readouterr().out
    assert "muted: Shape Detail Band 1" in said
    assert "driven, and do what their drivers say: Shape Detail Band 2" in said
    assert "keyframed; Keyframe keeps the new values: Shape Detail Band 3" in said
    assert "cut off at the ends of the sliders: Shape Detail Band 4" in said
    assert "only the active shape key is shown" in said


@pytest.mark.parametrize("bands", [2, 3, 4, 5, 9])
def test_every_preset_of_the_sidebar_does_something_as_it_stands(monkey, bands):
    bpy.ops.spectral_tv.decompose(bands=bands, steps=12)
    sidebar = bpy.context.scene.spectral_tv_filter
    assert 1 <= sidebar.first == sidebar.last <= bands
    for preset in ("LOW_PASS", "HIGH_PASS", "BAND_PASS", "BAND_STOP", "EXAGGERATE"):
        first, last = sidebar.chosen(preset)
        assert (first, last) == (sidebar.first, sidebar.last) or bands == 2
        assert any(gains.preset_values(preset, bands, first, last, sidebar.amount))
    for name in ("spectral_tv_attributes", "spectral_tv_images"):
        choices = getattr(bpy.context.scene, name)
        choices.bands = bands
        for preset in ("LOW_PASS", "HIGH_PASS", "BAND_PASS", "BAND_STOP", "EXAGGERATE"):
            choices.preset = preset
            chosen = choices.first, choices.last, choices.amount
            assert any(gains.preset_values(preset, bands, *chosen)), (name, preset)


def test_bands_that_are_chosen_in_the_sidebar_stay_chosen(banded):
    sidebar = bpy.context.scene.spectral_tv_filter
    sidebar.first = 4
    assert (sidebar.first, sidebar.last) == (4, 4) == sidebar.chosen("LOW_PASS")
    sidebar.own_first, sidebar.last = 0, 1
    assert (sidebar.first, sidebar.last) == (1, 1)
    sidebar.own_last = 0
    assert (sidebar.first, sidebar.last) == (3, 3)


def test_filter_leaves_other_keys_alone(banded):
    smile = banded.shape_key_add(name="Smile", from_mix=False)
    smile.value = 0.5
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=9)
    assert smile.value == pytest.approx(0.5)
    assert values(banded) == [-1, -1, -1, -1]


def test_curve_sets_bands_from_finest_to_largest(banded):
    bpy.ops.spectral_tv.add_curve()
    bpy.ops.spectral_tv.apply_curve()
    np.testing.assert_allclose(values(banded), 0, atol=1e-6)
    mapping = bpy.data.node_groups[".Spectral TV Filter"].nodes["Filter"].mapping
    points = mapping.curves[0].points
    points[0].location.y, points[1].location.y = 3.0, -1.0
    for point in points:
        point.handle_type = "VECTOR"
    mapping.update()
    bpy.ops.spectral_tv.apply_curve()
    np.testing.assert_allclose(values(banded), 3 - 4 * np.array([1, 3, 5, 7]) / 8 - 1, atol=1e-3)


def test_a_curve_that_was_deleted_is_drawn_anew(banded):
    bpy.ops.spectral_tv.add_curve()
    groups = len(bpy.data.node_groups)
    nodes = bpy.data.node_groups[".Spectral TV Filter"].nodes
    nodes.clear()
    bpy.ops.spectral_tv.add_curve()
    assert "Filter" in nodes and len(bpy.data.node_groups) == groups
    bpy.ops.spectral_tv.apply_curve()
    np.testing.assert_allclose(values(banded), 0, atol=1e-6)


def test_solo_mutes_the_others_and_gives_them_back(banded):
    keys = banded.data.shape_keys.key_blocks[1:]
    bpy.ops.spectral_tv.solo(band=2)
    assert [key.mute for key in keys] == [True, False, True, True]
    bpy.ops.spectral_tv.solo(band=2)
    assert not any(key.mute for key in keys)


def mutes(obj) -> list[bool]:
    return [key.mute for key in obj.data.shape_keys.key_blocks if "Band" in key.name]


def test_solo_gives_back_what_the_user_had_muted(banded):
    banded.data.shape_keys.key_blocks["Shape Detail Band 1"].mute = True
    bpy.ops.spectral_tv.solo(band=2)
    assert mutes(banded) == [True, False, True, True]
    bpy.ops.spectral_tv.solo(band=1)
    assert mutes(banded) == [False, True, True, True]
    bpy.ops.spectral_tv.solo(band=1)
    assert mutes(banded) == [True, False, False, False]


def test_what_is_muted_or_unmuted_meanwhile_stays_so(banded):
    keys = banded.data.shape_keys.key_blocks
    keys["Shape Detail Band 1"].mute = True
    bpy.ops.spectral_tv.solo(band=2)
    keys["Shape Detail Band 3"].mute = False
    keys["Shape Detail Band 2"].mute = True
    bpy.ops.spectral_tv.solo(band=4)
    assert mutes(banded) == [True, True, True, False]
    bpy.ops.spectral_tv.solo(band=4)
    assert mutes(banded) == [True, True, False, False]


def test_solo_is_kept_in_files(banded, tmp_path: Path):
    banded.data.shape_keys.key_blocks["Shape Detail Band 1"].mute = True
    bpy.ops.spectral_tv.solo(band=2)
    path, name = str(tmp_path / "solo.blend"), banded.name
    bpy.data.libraries.write(path, {banded})
    bpy.data.batch_remove([banded])
    with bpy.data.libraries.load(path) as (_, target):
        target.objects = [name]
    loaded = target.objects[0]
    bpy.context.collection.objects.link(loaded)
    activate(loaded)
    bpy.ops.spectral_tv.solo(band=2)
    assert mutes(loaded) == [True, False, False, False]
    with pytest.raises(RuntimeError, match="no band 5"):
        bpy.ops.spectral_tv.solo(band=5)


def test_keyframes_every_band(banded):
    for frame, value in ((1, 0.0), (20, 2.0)):
        bpy.context.scene.frame_set(frame)
        bpy.ops.spectral_tv.filter(preset="EXAGGERATE", first=1, last=4, amount=value)
        bpy.ops.spectral_tv.keyframe()
    bpy.context.scene.frame_set(20)
    np.testing.assert_allclose(values(banded), 2)
    bpy.context.scene.frame_set(1)
    np.testing.assert_allclose(values(banded), 0)


def test_bake_keeps_the_mix_as_a_key(banded):
    bpy.ops.spectral_tv.filter(preset="EXAGGERATE", first=2, last=3, amount=1)
    keys = banded.data.shape_keys.key_blocks
    basis, second, third = (shape(keys[i]) for i in (0, 2, 3))
    bpy.ops.spectral_tv.bake()
    baked = keys["Filtered"]
    assert baked.value == 0
    np.testing.assert_allclose(shape(baked), second + third - basis, atol=1e-6)


def test_copies_the_filter_to_other_poses(banded):
    other = banded.copy()
    other.data = banded.data.copy()
    plain = bpy.data.objects.new("Plain", bpy.data.meshes.new("Plain"))
    for obj in (other, plain):
        bpy.context.collection.objects.link(obj)
        obj.select_set(True)
    bpy.ops.spectral_tv.filter(preset="BAND_PASS", first=2, last=2)
    assert values(other) == [0, 0, 0, 0]
    assert bpy.ops.spectral_tv.copy_filter() == {"FINISHED"}
    assert values(other) == [-1, 0, -1, -1]


@pytest.mark.parametrize(
    "options",
    [{"use_scales": True, "largest": 20}, {"method": "M2"}, {"bands": 3}],
)
def test_a_filter_is_not_copied_to_bands_of_other_sizes(banded, capfd, options):
    other = banded.copy()
    other.data = banded.data.copy()
    other.shape_key_clear()
    bpy.context.collection.objects.link(other)
    activate(other)
    bpy.ops.spectral_tv.decompose(**{"bands": 4, "steps": 12, **options})
    activate(banded)
    other.select_set(True)
    with pytest.raises(RuntimeError, match="decompose these by the same settings first"):
        bpy.ops.spectral_tv.copy_filter()
    bpy.context.view_layer.objects.active = other
    scaled = other.copy()
    scaled.data, scaled.scale = other.data.copy(), (3, 3, 3)
    bpy.context.collection.objects.link(scaled)
    activate(scaled)
    bpy.ops.spectral_tv.decompose(**{"bands": 4, "steps": 12, **options})
    activate(other)
    scaled.select_set(True)
    assert bpy.ops.spectral_tv.copy_filter() == {"FINISHED"}


def test_cutting_again_uses_the_same_flow(banded):
    keys = banded.data.shape_keys.key_blocks
    total = sum(shape(key) - shape(keys[0]) for key in list(keys)[1:])
    extra = banded.shape_key_add(name="Smile", from_mix=False)
    bpy.ops.spectral_tv.cut(bands=6)
    assert [key.name for key in keys] == [
        "Basis",
        *(f"Shape Detail Band {i}" for i in range(1, 7)),
        extra.name,
    ]
    again = sum(shape(key) - shape(keys[0]) for key in list(keys)[1:7])
    np.testing.assert_allclose(again, total, atol=1e-5)
    bpy.ops.spectral_tv.filter(preset="RESET")
    with pytest.raises(RuntimeError, match="number of bands"):
        bpy.ops.spectral_tv.cut(bands=12)


def test_the_flow_is_recalled_until_the_shape_or_the_steps_change(banded):
    bands = import_module(f"{EXTENSION}.bands.bands")

    bands.flows.clear()  # those of other tests
    bpy.ops.spectral_tv.decompose(bands=4, steps=12)

    def is_recalled(**choices) -> bool:
        return bands.recall(*bands.prepare(banded, Settings(**choices))) is not None

    assert is_recalled(bands=4, steps=12)
    assert is_recalled(bands=7, steps=12)
    assert not is_recalled(bands=4, steps=13)
    assert not is_recalled(bands=4, steps=12, method="M2")
    banded.data.shape_keys.key_blocks["Basis"].data[5].co.x += 1e-3
    assert not is_recalled(bands=4, steps=12)


def test_the_spectrum_shows_the_bands_from_left_to_right(banded):
    spectrum = import_module(f"{EXTENSION}.bands.spectrum")
    record = banded.data.spectral_tv.decompositions[-1]
    bottom = [tuple(pixel) for pixel in spectrum.picture(record)[0]]
    colors = [tuple(np.float32(spectrum.color(band, 4))) for band in range(4)]
    seen = [pixel for pixel in bottom if pixel in colors]
    assert [pixel for pixel, _ in groupby(seen)] == colors
    assert spectrum.icon(record) == spectrum.icon(record)


def test_bands_survive_renaming_and_reordering(banded):
    keys = banded.data.shape_keys.key_blocks
    keys["Shape Detail Band 2"].name = "Wrinkles"
    keys["Shape Detail Band 3"].name = "Shape Detail Band 9"
    bpy.ops.spectral_tv.filter(preset="BAND_PASS", first=2, last=2)
    named = {key.name: key.value for key in keys}
    assert named["Wrinkles"] == 0
    assert (
        named["Shape Detail Band 1"]
        == named["Shape Detail Band 9"]
        == named["Shape Detail Band 4"]
        == -1
    )


def test_bands_survive_duplication_and_files(banded, tmp_path: Path):
    banded.data.shape_keys.key_blocks["Shape Detail Band 1"].name = "Fine"
    twin = banded.copy()
    twin.data = banded.data.copy()
    bpy.context.collection.objects.link(twin)
    activate(twin)
    bpy.ops.spectral_tv.filter(preset="LOW_PASS", first=2, last=2)
    assert twin.data.shape_keys.key_blocks["Fine"].value == -1
    assert banded.data.shape_keys.key_blocks["Fine"].value == 0

    path = tmp_path / "bands.blend"
    bpy.data.libraries.write(str(path), {twin})
    name = twin.name
    bpy.data.batch_remove([twin, banded])
    with bpy.data.libraries.load(str(path)) as (_, target):
        target.objects = [name]
    loaded = target.objects[0]
    bpy.context.collection.objects.link(loaded)
    activate(loaded)
    bpy.ops.spectral_tv.filter(preset="RESET")
    assert loaded.data.shape_keys.key_blocks["Fine"].value == 0
    assert len(loaded.data.spectral_tv.decompositions[-1].kept_spectrum) == 11


def test_another_key_by_the_name_of_a_deleted_band_is_no_band(banded):
    banded.shape_key_remove(banded.data.shape_keys.key_blocks["Shape Detail Band 3"])
    smile = banded.shape_key_add(name="Shape Detail Band 3", from_mix=False)
    for point in list(smile.data)[:9]:
        point.co.z += 0.1
    assert smile.name == "Shape Detail Band 3"
    smile.value = 0.5
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=4)
    assert values(banded) == [-1, -1, -1, 0.5]
    bpy.ops.spectral_tv.cut(bands=2)
    assert "Shape Detail Band 3" in banded.data.shape_keys.key_blocks


def test_another_key_by_the_name_of_a_renamed_band_is_no_band(banded):
    keys = banded.data.shape_keys.key_blocks
    keys["Shape Detail Band 3"].name = "Folds"
    banded.shape_key_add(name="Shape Detail Band 3", from_mix=False).value = 0.5
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=4)
    assert keys["Shape Detail Band 3"].value == 0.5 and keys["Folds"].value == -1


def test_a_sculpted_band_is_a_band(banded):
    for point in list(banded.data.shape_keys.key_blocks["Shape Detail Band 1"].data)[:50]:
        point.co.z += 0.5
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=1)
    assert values(banded) == [-1, 0, 0, 0]


def test_bands_outlive_sculpting_of_basis_and_new_names(banded):
    bpy.ops.object.mode_set(mode="EDIT")
    banded.active_shape_key_index = 0
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.transform.translate(value=(0.1, 0.23, 0.37))
    bpy.ops.object.mode_set(mode="OBJECT")
    banded.data.shape_keys.key_blocks["Shape Detail Band 2"].name = "Wrinkles"
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=4)
    assert values(banded) == [-1, -1, -1]
    assert banded.data.shape_keys.key_blocks["Wrinkles"].value == -1


def fill_spectrum(record, kept) -> None:
    """Keep a spectrum as a collection, as older versions did."""
    for time, strength in kept.kept_spectrum:
        sample = record.spectrum.add()
        sample.time, sample.strength = time, strength


def test_bands_of_a_file_of_0_1_0_are_known(banded):
    """It kept names and digests, and no settings, on the shape keys."""
    record, kept = banded.data.shape_keys.spectral_tv, banded.data.spectral_tv.decompositions[-1]
    for name in ("identifier", "method", "area", "topology", "vertex_count", "corner_count"):
        setattr(record, name, getattr(kept, name))
    fill_spectrum(record, kept)
    for each in kept.bands:
        band = record.bands.add()
        band.key, band.digest, band.start, band.end = each.key, each.digest, each.start, each.end
    kept.bands.clear()
    for band in record.bands:
        band.property_unset("sketch")
        band.property_unset("places")
        band.property_unset("moves")
    keys = banded.data.shape_keys.key_blocks
    keys["Shape Detail Band 2"].name = "Wrinkles"
    keys["Shape Detail Band 3"].data[7].co.z += 0.1
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=4)
    assert [key.value for key in keys][1:] == [-1, -1, -1, -1]
    assert bpy.ops.spectral_tv.measure_accuracy(of_bands=True) == {"FINISHED"}
    assert "Shape Detail Error of Bands" in banded.data.attributes


def test_a_spectrum_that_is_kept_as_a_collection_is_read(banded):
    """It was so before it became one text."""
    record = banded.data.spectral_tv.decompositions[-1]
    kept = record.kept_spectrum
    picture = import_module(f"{EXTENSION}.bands.spectrum").picture
    drawn = picture(record)
    fill_spectrum(record, record)
    record.property_unset("components")
    np.testing.assert_array_equal(record.kept_spectrum, kept)
    np.testing.assert_array_equal(picture(record), drawn)
    bpy.ops.spectral_tv.decompose(bands=4, steps=12)
    assert not record.spectrum and len(record.kept_spectrum) == 11


def test_bands_go_with_all_shape_keys(banded):
    """Others that are added later are none of them."""
    banded.shape_key_clear()
    assert not bpy.ops.spectral_tv.filter.poll()
    banded.shape_key_add(name="Basis")
    banded.shape_key_add(name="Shape Detail Band 1")
    assert not bpy.ops.spectral_tv.filter.poll()
    bpy.ops.spectral_tv.decompose(bands=2, steps=8)
    assert bpy.ops.spectral_tv.filter.poll()


def test_a_deleted_band_is_left_out(banded):
    banded.shape_key_remove(banded.data.shape_keys.key_blocks["Shape Detail Band 3"])
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=4)
    assert values(banded) == [-1, -1, -1]


def test_a_changed_mesh_is_refused(banded):
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    bpy.ops.object.mode_set(mode="OBJECT")
    for operator in (bpy.ops.spectral_tv.filter, bpy.ops.spectral_tv.cut):
        with pytest.raises(RuntimeError, match="decompose the mesh again"):
            operator()
    bpy.ops.spectral_tv.decompose(bands=2, steps=6)
    bpy.ops.spectral_tv.filter(preset="RESET")


def test_no_bands_is_a_message(monkey):
    with pytest.raises(RuntimeError, match="no bands; decompose it first"):
        bpy.ops.spectral_tv.filter()


def test_vertex_group_limits_the_bands(monkey):
    monkey.vertex_groups.new(name="Face").add(range(50), 1.0, "REPLACE")
    bpy.ops.spectral_tv.decompose(bands=2, steps=8, vertex_group="Face")
    keys = monkey.data.shape_keys.key_blocks[1:]
    assert all(key.vertex_group == "Face" for key in keys)
    bpy.ops.spectral_tv.cut(bands=3)
    assert all(key.vertex_group == "Face" for key in monkey.data.shape_keys.key_blocks[1:])
    with pytest.raises(RuntimeError, match="no vertex group 'Feet'"):
        bpy.ops.spectral_tv.decompose(vertex_group="Feet")


def test_scales_are_relative_to_the_size(monkey):
    record = []
    for scale in (1.0, 10.0):
        monkey.scale = (scale,) * 3
        bpy.context.view_layer.update()
        bpy.ops.spectral_tv.decompose(bands=2, steps=6, use_scales=True, finest=1, largest=10)
        kept = monkey.data.spectral_tv.decompositions[-1]
        record.append((kept.bands[1].end / kept.area, kept.area))
    assert record[0][0] == pytest.approx(record[1][0], rel=1e-4) == pytest.approx(0.01, rel=1e-4)
    assert record[1][1] == pytest.approx(100 * record[0][1], rel=1e-4)
    with pytest.raises(RuntimeError, match="finest scale"):
        bpy.ops.spectral_tv.decompose(use_scales=True, finest=10, largest=5)


@pytest.mark.parametrize("method", ["M1", "M2", "M2_P2", "M3", "HEAT", "LB", "DISPLACEMENT"])
def test_ticking_scales_or_smoothing_changes_nothing(method):
    """The greyed numbers are the method's own, and stay in force until one is touched."""
    choices = bpy.context.scene.spectral_tv
    choices.method = method
    before = choices.settings()
    name = method.lower().partition("_")[0]
    own = spectral_tv.default_scales(name, choices.eigenpairs, "limbs")
    for _ in range(2):
        shown = choices.shown_finest, choices.shown_largest, choices.shown_base_amount
        expected = [100 * np.sqrt(area) for area in (*own, spectral_tv.default_base_time("limbs"))]
        np.testing.assert_allclose(shown, expected, rtol=1e-6)
        assert choices.settings() == before
        choices.use_scales = choices.use_base_amount = True
    choices.shown_finest = 2
    assert choices.settings() == replace(before, finest=0.02)
    choices.use_scales = False
    assert choices.shown_finest == pytest.approx(100 * np.sqrt(own[0]))
    choices.use_scales = True
    assert choices.shown_finest == 2
    choices.finest, choices.use_scales, choices.use_base_amount = 0, False, False
    choices.property_unset("method")


def test_unset_scales_of_an_operator_are_the_methods_own(monkey):
    bpy.ops.spectral_tv.decompose(method="M2", bands=2, steps=6)
    before = monkey.data.spectral_tv.decompositions[-1].identifier
    times = [band.end for band in monkey.data.spectral_tv.decompositions[-1].bands]
    bpy.ops.spectral_tv.decompose(method="M2", bands=2, steps=6, use_scales=True)
    record = monkey.data.spectral_tv.decompositions[-1]
    assert [band.end for band in record.bands] == times and record.identifier != before
    bpy.ops.spectral_tv.decompose(method="M2", bands=2, steps=6, use_scales=True, largest=20)
    assert record.bands[-1].end / record.area == pytest.approx(0.04, rel=1e-5)


def test_bases_of_m3():
    """A relief over its flattened self moves along Z alone; a shape key serves as well."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=40, y_subdivisions=40)
    obj = bpy.context.object
    for vertex in obj.data.vertices:
        vertex.co.z = 0.2 * np.sin(6 * vertex.co.x) * np.cos(5 * vertex.co.y)
    bpy.ops.spectral_tv.decompose(method="M3", bands=3, steps=8, base="FLAT")
    keys = obj.data.shape_keys.key_blocks
    moves = (shape(keys["Edge-Keeping Detail Band 3"]) - shape(keys["Basis"])).reshape(-1, 3)
    assert np.abs(moves[:, :2]).max() < 1e-6 < np.abs(moves[:, 2]).max()

    flat = obj.shape_key_add(name="Flat", from_mix=False)
    for point in flat.data:
        point.co.z = -0.2
    bpy.ops.spectral_tv.decompose(method="M3", bands=3, steps=8, base="KEY", base_key="Flat")
    again = (shape(keys["Edge-Keeping Detail Band 3"]) - shape(keys["Basis"])).reshape(-1, 3)
    np.testing.assert_allclose(again, moves, atol=1e-4)
    with pytest.raises(RuntimeError, match="no shape key 'Nothing'"):
        bpy.ops.spectral_tv.decompose(method="M3", base="KEY", base_key="Nothing")


def test_everything_in_the_interface_has_a_tooltip():
    for name in dir(bpy.ops.spectral_tv):
        rna = getattr(bpy.ops.spectral_tv, name).get_rna_type()
        assert len(rna.description) > 10, name
        for prop in rna.properties:
            if prop.identifier != "rna_type":
                assert prop.description or prop.identifier in ("method", "preset", "bands"), (
                    f"{name}.{prop.identifier}"
                )
