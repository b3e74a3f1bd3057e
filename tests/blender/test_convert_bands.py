"""Bands turn from shape keys into attributes and back, with all that was set of them."""

from __future__ import annotations

from importlib import import_module

import bpy
import numpy as np
import pytest
from ball import bumpy_ball
from conftest import MODULE
from deform_scene import evaluated

OPS = bpy.ops.spectral_tv
SMALL = {"bands": 3, "steps": 8}
RECORDS = import_module(f"{MODULE}.scene.records")
CHANNELS = import_module(f"{MODULE}.scene.channels")
FRAMES = (1, 4, 9, 13, 20)


def bands(obj):
    return RECORDS.bands_of(obj)


@pytest.fixture
def obj():
    """Bands with values, a mask, a mute, keyframes, a driver, and a driver that reads one."""
    obj = bumpy_ball()
    obj.select_set(True)
    OPS.decompose(**SMALL)
    first, second, third = bands(obj)
    first.value, second.value, third.value = 1.5, -0.4, 4.0 if third.slider_max >= 4 else 0.7
    OPS.fill_mask(band=2, source="GROUP", group="Cap")
    for frame, value in ((1, 0.2), (9, 1.4), (20, -0.5)):
        first.value = value
        first.keyframe_insert("value", frame=frame)
    curve = CHANNELS.actions_of(obj.data.shape_keys)[0].curves[0]
    curve.keyframe_points[1].interpolation = "ELASTIC"
    curve.modifiers.new("NOISE").strength = 0.3
    second.mute = True
    second.keyframe_insert("mute", frame=1)
    second.mute = False
    second.keyframe_insert("mute", frame=10)
    driver = third.driver_add("value").driver
    driver.expression = "0.1 * frame + other"
    variable = driver.variables.new()
    variable.name = "other"
    variable.targets[0].id_type, variable.targets[0].id = "KEY", obj.data.shape_keys
    variable.targets[0].data_path = first.path_from_id("value")
    reader = obj.driver_add("location", 0).driver
    reader.expression = "read"
    variable = reader.variables.new()
    variable.name = "read"
    variable.targets[0].id_type, variable.targets[0].id = "MESH", obj.data
    variable.targets[0].data_path = f"shape_keys.{first.path_from_id('value')}"
    bpy.context.scene.frame_set(1)
    return obj


def film(obj) -> list[tuple[np.ndarray, list[float], list[bool], float]]:
    """What is seen and set on some frames."""
    found = []
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        values = [(band.value, band.mute, band.vertex_group) for band in bands(obj)]
        found.append((evaluated(obj), values, obj.location.x))
    bpy.context.scene.frame_set(1)
    return found


def assert_same_film(one, other) -> None:
    for (shape, values, x), (shape2, values2, x2) in zip(one, other, strict=True):
        np.testing.assert_allclose(shape2, shape, rtol=0, atol=2e-6)
        assert [each[1:] for each in values2] == [each[1:] for each in values]
        now, before = ([each[0] for each in some] for some in (values2, values))
        np.testing.assert_allclose(now, before, rtol=0, atol=1e-5)
        assert x2 == pytest.approx(x, abs=1e-5)


def test_all_that_was_set_goes_over_and_back(obj):
    before, names = film(obj), [band.name for band in bands(obj)]
    ranges = [(band.slider_min, band.slider_max) for band in bands(obj)]
    moves = [RECORDS.keeping_of(RECORDS.record_of(obj)).displacement(b) for b in bands(obj)]
    assert before[0][2] != before[2][2] and before[0][1] != before[3][1]
    for kind in ("ATTRIBUTES", "KEYS", "ATTRIBUTES", "KEYS"):
        assert OPS.convert_bands(to=kind) == {"FINISHED"}
        record = RECORDS.record_of(obj)
        assert record.kept == kind
        assert_same_film(before, film(obj))
        assert [band.name for band in bands(obj)] == names
        assert [(band.slider_min, band.slider_max) for band in bands(obj)] == ranges
        for band, moved in zip(bands(obj), moves, strict=True):
            # As exact as coordinates are.
            found = RECORDS.keeping_of(record).displacement(band)
            np.testing.assert_allclose(found, moved, rtol=0, atol=2.0**-23)
        has_keys = obj.data.shape_keys is not None
        assert has_keys == (kind == "KEYS") and bool(obj.modifiers) != has_keys
    assert bands(obj)[0].name in obj.data.shape_keys.key_blocks


def test_keys_that_become_attributes_and_keys_again_are_the_same_to_the_last_bit(obj):
    def points():
        blocks = obj.data.shape_keys.key_blocks
        return {key.name: np.array([point.co for point in key.points]) for key in blocks}

    before = points()
    OPS.convert_bands(to="ATTRIBUTES")
    OPS.convert_bands(to="KEYS")
    after = points()
    assert after.keys() == before.keys()
    for name, found in after.items():
        np.testing.assert_allclose(found, before[name], rtol=0, atol=1e-9)


def test_curves_keep_their_interpolation_and_modifiers(obj):
    OPS.convert_bands(to="ATTRIBUTES")
    (curve,) = [
        each
        for animated in CHANNELS.actions_of(obj)
        for each in animated.curves
        if len(each.keyframe_points) == 3
    ]
    assert curve.keyframe_points[1].interpolation == "ELASTIC"
    assert curve.modifiers[0].type == "NOISE"
    assert curve.modifiers[0].strength == pytest.approx(0.3)


def test_a_cut_after_a_conversion_needs_no_new_flow(obj):
    shape = evaluated(obj)
    obj.animation_data_clear()
    OPS.convert_bands(to="ATTRIBUTES")
    assert OPS.cut(bands=3) == {"FINISHED"}
    np.testing.assert_allclose(evaluated(obj), shape, rtol=0, atol=1e-5)


def test_other_keys_stay_and_bands_are_the_only_ones_to_go(obj):
    smile = obj.shape_key_add(name="Smile", from_mix=False)
    smile.relative_key = bands(obj)[0]
    for point in smile.points:
        point.co.z += 0.1
    smile.value = 0.5
    before = evaluated(obj)
    OPS.convert_bands(to="ATTRIBUTES")
    assert obj.data.shape_keys.key_blocks.keys() == ["Basis", "Smile"]
    np.testing.assert_allclose(evaluated(obj), before, rtol=0, atol=1e-6)


def test_names_that_something_else_has_are_told(obj):
    obj.vertex_groups.new(name=bands(obj)[1].name)
    OPS.convert_bands(to="ATTRIBUTES")
    assert bands(obj)[1].name == "Shape Detail Band 2.001"


def test_a_mask_that_is_a_number_becomes_a_vertex_group(obj):
    OPS.convert_bands(to="ATTRIBUTES")
    inputs = import_module(f"{MODULE}.scene.node_inputs")
    first = bands(obj)[0]
    inputs.set_value(first.modifier, first.entry.mask, 0.5)
    before = evaluated(obj)
    OPS.convert_bands(to="KEYS")
    np.testing.assert_allclose(evaluated(obj), before, rtol=0, atol=2e-6)
    assert bands(obj)[0].vertex_group == "Shape Detail Band 1 Mask"


def test_what_was_sculpted_stays_known_as_such(obj):
    band = bands(obj)[1]
    for point in list(band.points)[:40]:
        point.co.x += 0.1
    for kind in ("ATTRIBUTES", "KEYS"):
        OPS.convert_bands(to=kind)
        likes = [int(likeness) for _, likeness in RECORDS.recognise_bands(obj)]
        assert likes == [2, 1, 2]


def test_strips_of_the_nla_are_a_reason(obj):
    animation = obj.data.shape_keys.animation_data
    strip = animation.nla_tracks.new().strips.new("Strip", 1, animation.action)
    assert strip is not None
    before = obj.data.shape_keys.key_blocks.keys()
    with pytest.raises(RuntimeError, match="NLA Editor"):
        OPS.convert_bands(to="ATTRIBUTES")
    assert obj.data.shape_keys.key_blocks.keys() == before and not obj.modifiers
    assert not [each for each in obj.data.attributes if "Band" in each.name]


def test_what_they_are_already_is_a_reason(obj):
    with pytest.raises(RuntimeError, match="shape keys already"):
        OPS.convert_bands(to="KEYS")
