"""bpy.ops.spectral_tv.measure_thickness: a float attribute of radii, in the scene's unit."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from ball import object_of
from shapes import icosphere


@pytest.fixture
def egg():
    obj = object_of("Egg", *icosphere(3))
    obj.scale = 3, 3, 3
    bpy.context.view_layer.update()
    return obj


def thickness(obj) -> np.ndarray:
    found = np.empty(len(obj.data.vertices), np.float32)
    obj.data.attributes["Thickness"].data.foreach_get("value", found)
    return found


def test_a_ball_is_as_thick_as_its_radius_in_the_world(egg):
    assert bpy.ops.spectral_tv.measure_thickness() == {"FINISHED"}
    assert np.abs(thickness(egg) / 3 - 1).max() < 0.05
    assert egg.data.shape_keys is None


def test_the_shape_that_is_shown_is_measured_and_the_result_is_replaced(egg):
    bpy.ops.spectral_tv.measure_thickness()
    egg.shape_key_add(name="Basis")
    key = egg.shape_key_add(name="Large", from_mix=False)
    for point in key.data:
        point.co *= 2
    key.value = 1
    bpy.ops.spectral_tv.measure_thickness()
    assert np.abs(thickness(egg) / 6 - 1).max() < 0.05
    assert [each.name for each in egg.data.attributes if "Thick" in each.name] == ["Thickness"]


def test_an_attribute_that_was_changed_is_kept(egg, capfd):
    bpy.ops.spectral_tv.measure_thickness()
    egg.data.attributes["Thickness"].data[0].value = 7
    bpy.ops.spectral_tv.measure_thickness()
    assert egg.data.attributes["Thickness"].data[0].value == 7
    assert "was changed since, and is kept" in capfd.readouterr().out
    assert "Thickness.001" in egg.data.attributes
