"""A shape key moves the vertices from the key that it is relative to, which need not be Basis."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from ball import object_of
from shapes import bumpy_sphere

VERTICES, FACES = bumpy_sphere(3, amplitude=0.2)
CAP = VERTICES[:, 2] > 0.5
ASIDE = np.array([0.125, 0, 0])
flow = bpy.ops.spectral_tv.flow_attribute


def positions(key) -> np.ndarray:
    return np.array([point.co for point in key.data])


def moved(obj, name: str) -> np.ndarray:
    key = obj.data.shape_keys.key_blocks[name]
    return positions(key) - positions(key.relative_key)


def seen(obj) -> np.ndarray:
    graph = bpy.context.evaluated_depsgraph_get()
    return np.array([vertex.co for vertex in obj.evaluated_get(graph).data.vertices])


def add_key(obj, name: str, shape: np.ndarray, relative: str = "Basis") -> bpy.types.ShapeKey:
    key = obj.shape_key_add(name=name, from_mix=False)
    for point, co in zip(key.data, shape, strict=True):
        point.co = co
    key.relative_key = obj.data.shape_keys.key_blocks[relative]
    return key


@pytest.fixture
def body():
    """Keys Wide, Lift relative to Wide, Turn relative to Lift; and what Lift does, from Basis."""
    obj = object_of("Body", VERTICES, FACES)
    obj.shape_key_add(name="Basis")
    wide = VERTICES * [2, 2, 1]
    lift = wide + CAP[:, np.newaxis] * [0, 0, 0.5]
    add_key(obj, "Wide", wide)
    add_key(obj, "Lift", lift, "Wide")
    add_key(obj, "Turn", lift + CAP[:, np.newaxis] * [0.25, 0, 0], "Lift")
    add_key(obj, "Plain", VERTICES + CAP[:, np.newaxis] * [0, 0, 0.5])
    return obj


def test_what_flows_is_what_the_key_does(body):
    for source in ("Plain", "Lift"):
        flow(kind="KEY", source=source, size=10, steps=8)
        flow(kind="KEY", source=source, result="BANDS", bands=2, steps=8)
    for label in ("Flow", "Band 1", "Band 2", "Rest"):
        expected, found = moved(body, f"Plain {label}"), moved(body, f"Lift {label}")
        np.testing.assert_allclose(found, expected, atol=1e-5)
    flow(kind="KEY", source="Turn", size=10, steps=8)
    turned = moved(body, "Turn Flow")
    assert turned[:, 0].max() > 0.1 and np.abs(turned[:, 2]).max() < 1e-5


def test_a_key_that_is_relative_to_itself_does_nothing(body):
    keys = body.data.shape_keys.key_blocks
    keys["Lift"].relative_key = keys["Lift"]
    with pytest.raises(RuntimeError, match="the same everywhere"):
        flow(kind="KEY", source="Lift", steps=8)


def test_basis_may_be_removed(body):
    """The next key is the shape then, and those that leaned on Basis lean on that."""
    body.shape_key_remove(body.data.shape_keys.key_blocks["Basis"])
    keys = body.data.shape_keys
    assert keys.reference_key.name == "Wide"
    before = moved(body, "Plain")
    flow(kind="KEY", source="Plain", size=0.01, steps=2)
    np.testing.assert_allclose(moved(body, "Plain Flow"), before, atol=0.02)
    shape = seen(body)
    keys.key_blocks["Plain Flow"].value = 1
    np.testing.assert_allclose(seen(body) - shape, moved(body, "Plain Flow"), atol=1e-5)


def test_a_result_that_was_made_relative_to_another_key_does_what_it_should(body):
    flow(kind="KEY", source="Plain", size=10, steps=8)
    expected = moved(body, "Plain Flow")
    flow(kind="KEY", source="Plain", size=30, steps=8)
    keys = body.data.shape_keys.key_blocks
    key = keys["Plain Flow"]
    shift = positions(keys["Wide"]) - positions(keys["Basis"])
    key.relative_key = keys["Wide"]
    for point, co in zip(key.data, positions(key) + shift, strict=True):
        point.co = co
    flow(kind="KEY", source="Plain", size=10, steps=8)
    assert "Plain Flow.001" not in keys and key.relative_key.name == "Wide"
    np.testing.assert_allclose(moved(body, "Plain Flow"), expected, atol=1e-5)


def test_keys_that_lean_on_a_result_do_what_they_did(body):
    """Both when it is written over and when it is removed."""
    flow(kind="KEY", source="Plain", result="BANDS", bands=3, steps=8)
    keys = body.data.shape_keys.key_blocks
    for name, on in (("One", "Plain Band 1"), ("Two", "One"), ("Three", "Plain Band 3")):
        add_key(body, name, positions(keys[on]) + ASIDE, on)
    before = [positions(keys[name]) for name in ("Plain Band 1", "Plain Band 3")]
    flow(kind="KEY", source="Plain", result="BANDS", bands=2, steps=8)
    assert np.abs(positions(keys["Plain Band 1"]) - before[0]).max() > 1e-3
    assert "Plain Band 3" not in keys
    for name in ("One", "Two", "Three"):
        np.testing.assert_allclose(moved(body, name) - ASIDE, 0, atol=1e-6)


def test_a_base_is_the_shape_that_the_key_shows(body):
    smooth = VERTICES / np.linalg.norm(VERTICES, axis=1, keepdims=True)
    add_key(body, "Smooth", smooth)
    keys = body.data.shape_keys.key_blocks
    add_key(body, "Smooth too", positions(keys["Wide"]) + smooth - VERTICES, "Wide")
    found = []
    for name in ("Smooth", "Smooth too"):
        options = {"bands": 2, "steps": 6, "base": "KEY", "base_key": name}
        bpy.ops.spectral_tv.decompose(method="M3", **options)
        record = body.data.spectral_tv.decompositions[-1]
        found.append([moved(body, band.key) for band in record.bands])
    np.testing.assert_allclose(found[1], found[0], atol=1e-5)
    assert np.abs(found[0]).max() > 1e-3


def test_bands_that_are_taken_are_what_they_do(body):
    twin = body.copy()
    twin.data = body.data.copy()
    bpy.context.scene.collection.objects.link(twin)
    for obj in (twin, body):
        bpy.context.view_layer.objects.active = obj
        obj.select_set(True)
        bpy.ops.spectral_tv.decompose(bands=2, steps=6)
    keys = twin.data.shape_keys.key_blocks
    expected, shift = moved(twin, "M1 Band 2"), positions(keys["Wide"]) - VERTICES
    band = keys["M1 Band 2"]
    band.relative_key = keys["Wide"]
    for point, co in zip(band.data, positions(band) + shift, strict=True):
        point.co = co
    bpy.ops.spectral_tv.take_bands(first=2, last=2)
    taken = body.data.shape_keys.key_blocks["Body.001 M1 Band 2"]
    np.testing.assert_allclose(moved(body, taken.name), expected, atol=1e-5)
