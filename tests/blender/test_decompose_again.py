"""Decomposed again: the new bands take over what was set of the old ones, and the look stays."""

from __future__ import annotations

import banded_ball
import bpy
import numpy as np
import pytest
from banded_ball import STEPS, active, decompose, listed, names, seen, told, values

obj, keys = banded_ball.obj, banded_ball.keys


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
