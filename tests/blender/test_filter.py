"""Filters of the sidebar, presets and the curve: set, keyframed, baked, copied to other poses."""

from __future__ import annotations

import banded_monkey
import bpy
import numpy as np
import pytest
from banded_monkey import activate, shape, values
from spectral_tv.bands import gains

banded = banded_monkey.banded


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
