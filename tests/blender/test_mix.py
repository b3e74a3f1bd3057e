"""bpy.ops.spectral_tv.take_bands: the detail of one mesh on another."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from mathutils import Euler


def positions(obj, name: str) -> np.ndarray:
    data = obj.data.shape_keys.key_blocks[name].data
    flat = np.empty(3 * len(data), dtype=np.float32)
    data.foreach_get("co", flat)
    return flat.reshape(-1, 3).astype(float)


def offsets(obj, name: str) -> np.ndarray:
    return positions(obj, name) - positions(obj, "Basis")


@pytest.fixture
def pair(monkey):
    """Two monkeys of the same vertices, one with ripples."""
    twin = bpy.data.objects.new("Twin", monkey.data.copy())
    bpy.context.scene.collection.objects.link(twin)
    for vertex in twin.data.vertices:
        vertex.co.z += 0.02 * np.sin(40 * vertex.co.x)
    for obj in (monkey, twin):
        bpy.context.view_layer.objects.active = obj
        bpy.ops.spectral_tv.decompose(bands=4, steps=12)
        obj.select_set(True)
    bpy.context.view_layer.objects.active = monkey
    return monkey, twin


def test_the_chosen_bands_are_replaced(pair):
    obj, twin = pair
    assert bpy.ops.spectral_tv.take_bands(first=1, last=2) == {"FINISHED"}
    keys = obj.data.shape_keys.key_blocks
    assert [key.name for key in keys][-2:] == ["Twin M1 Band 1", "Twin M1 Band 2"]
    assert [keys[f"M1 Band {band}"].value for band in (1, 2, 3, 4)] == [-1, -1, 0, 0]
    ratio = np.sqrt(
        obj.data.spectral_tv.decompositions[-1].area / twin.data.spectral_tv.decompositions[-1].area
    )
    for band in (1, 2):
        taken = offsets(obj, f"Twin M1 Band {band}")
        np.testing.assert_allclose(taken, ratio * offsets(twin, f"M1 Band {band}"), atol=1e-6)
        assert keys[f"Twin M1 Band {band}"].value == 1
    assert [key.value for key in twin.data.shape_keys.key_blocks[1:]] == [0, 0, 0, 0]


def shown(obj) -> np.ndarray:
    graph = bpy.context.evaluated_depsgraph_get()
    return np.array([vertex.co for vertex in obj.evaluated_get(graph).data.vertices])


def test_taking_again_takes_the_place_of_what_was_taken(pair):
    obj, twin = pair
    bpy.ops.spectral_tv.take_bands(first=1, last=2)
    before, names = shown(obj), obj.data.shape_keys.key_blocks.keys()
    bpy.ops.spectral_tv.take_bands(first=1, last=2)
    assert obj.data.shape_keys.key_blocks.keys() == names
    np.testing.assert_array_equal(shown(obj), before)
    third = bpy.data.objects.new("Third", twin.data.copy())
    bpy.context.scene.collection.objects.link(third)
    twin.select_set(False)
    third.select_set(True)
    third.data.shape_keys.key_blocks["M1 Band 1"].name = "Skin"
    bpy.ops.spectral_tv.take_bands(first=1, last=1)
    assert obj.data.shape_keys.key_blocks.keys()[-2:] == ["Twin M1 Band 2", "Third Skin"]
    np.testing.assert_allclose(shown(obj), before, atol=1e-6)


def test_turned_and_scaled_objects_keep_the_detail_in_proportion(pair):
    obj, twin = pair
    twin.matrix_world = Euler((0.3, 0.8, 0)).to_matrix().to_4x4() * 2.0
    bpy.context.view_layer.objects.active = twin
    bpy.ops.spectral_tv.decompose(bands=4, steps=12)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.spectral_tv.take_bands(first=3, last=3)
    (name,) = [key.name for key in obj.data.shape_keys.key_blocks if key.name.startswith("Twin")]
    source = name.removeprefix("Twin ")
    sizes = [np.linalg.norm(offsets(each, key)) for each, key in ((obj, name), (twin, source))]
    assert sizes[0] == pytest.approx(sizes[1], rel=0.05)


def test_what_cannot_be_taken_is_told(pair):
    obj, twin = pair
    with pytest.raises(RuntimeError, match="it has no band 7"):
        bpy.ops.spectral_tv.take_bands(first=7, last=9)
    twin.select_set(False)
    with pytest.raises(RuntimeError, match="select the one object"):
        bpy.ops.spectral_tv.take_bands()
    twin.select_set(True)
    bpy.context.view_layer.objects.active = twin
    bpy.ops.spectral_tv.cut(bands=3)
    bpy.context.view_layer.objects.active = obj
    with pytest.raises(RuntimeError, match="4 bands, but Twin has 3"):
        bpy.ops.spectral_tv.take_bands()
    twin.shape_key_clear()
    with pytest.raises(RuntimeError, match="Twin has no bands to take"):
        bpy.ops.spectral_tv.take_bands()
    assert not any(key.name.startswith("Twin") for key in obj.data.shape_keys.key_blocks)
