"""bpy.ops.spectral_tv.caricature: one exaggeration for many poses."""

from __future__ import annotations

from importlib import import_module

import bpy
import numpy as np
import pytest
import spectral_tv
from ball import object_of
from conftest import MODULE
from shapes import bumpy_sphere

VERTICES, FACES = bumpy_sphere(3, amplitude=0.2)


def pose(name: str, vertices: np.ndarray) -> bpy.types.Object:
    obj = object_of(name, vertices, FACES)
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    return obj


@pytest.fixture
def poses():
    """A bumpy ball, the same twice as large and turned, and bent."""
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    bend = VERTICES + 0.3 * VERTICES[:, 2:] ** 2 * [1, 0, 0]
    return [pose("Ball", VERTICES), pose("Large", 2 * VERTICES @ turn.T), pose("Bent", bend)]


def values(obj: bpy.types.Object) -> list[float]:
    return [key.value for key in obj.data.shape_keys.key_blocks[1:]]


def shown(obj: bpy.types.Object) -> np.ndarray:
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return np.array([vertex.co for vertex in evaluated.data.vertices])


def test_all_poses_get_the_same_filter_of_their_own_bands(poses):
    result = bpy.ops.spectral_tv.caricature(
        bands=5, steps=16, first=4, last=5, amount=1.5, smooth=1
    )
    assert result == {"FINISHED"}
    for obj in poses:
        assert [key.name for key in obj.data.shape_keys.key_blocks[1:]] == [
            f"Shape Detail Band {band}" for band in range(1, 6)
        ]
        np.testing.assert_allclose(values(obj), [-1, 0, 0, 1.5, 1.5])
    ball, large, bent = (shown(obj) for obj in poses)
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    np.testing.assert_allclose(large, 2 * ball @ turn.T, atol=2e-3)  # size and place do not matter
    assert np.abs(bent - ball).max() > 0.1


def test_it_is_the_package_s_caricature(poses):
    bpy.ops.spectral_tv.caricature(bands=3, steps=16, first=3, last=3, amount=1, smooth=1)
    meshes = [spectral_tv.Mesh(np.array([v.co for v in obj.data.vertices]), FACES) for obj in poses]
    split = spectral_tv.decompose(meshes[0], steps=16)
    edges = split.band_edges(3) / meshes[0].area
    how = {"method": "m1", "steps": 16, "keep_limbs": 0.5, "soft_edges": 0.3}
    found = spectral_tv.caricature(meshes, (edges[2], 1.0), gain=2, smooth=edges[1], **how)
    for obj, shape in zip(poses, found, strict=True):
        np.testing.assert_allclose(shown(obj), shape, atol=1e-4 * np.ptp(shape))


def test_amplified_bands_stand_out_and_smoothed_ones_are_gone(poses):
    """The filtered ball is nearer to itself without its finest band than with it."""
    bpy.ops.spectral_tv.caricature(bands=4, steps=16, first=4, last=4, amount=0, smooth=1)
    obj = poses[0]
    keys = obj.data.shape_keys.key_blocks
    basis, finest = (
        np.array([point.co for point in keys[name].data])
        for name in ("Basis", "Shape Detail Band 1")
    )
    np.testing.assert_allclose(shown(obj), basis - (finest - basis), atol=1e-5)


def test_bands_in_memory_are_not_flowed_again(poses):
    bands = import_module(f"{MODULE}.bands.bands")
    bands.flows.clear()
    bpy.ops.spectral_tv.caricature(bands=3, steps=8, smooth=0)
    flows = {id(flow.split) for flow in bands.flows.values()}
    assert len(flows) == 3
    for obj in poses:  # what is seen is split
        for key in obj.data.shape_keys.key_blocks[1:]:
            key.value = 0
    bpy.ops.spectral_tv.caricature(bands=4, steps=8, smooth=0)
    assert {id(flow.split) for flow in bands.flows.values()} == flows


def test_refusals_change_nothing(poses):
    for options, message in (
        ({"bands": 3, "smooth": 3}, "smoothing 3 of 3 bands leaves none"),
        ({"bands": 8, "steps": 8}, "Bent: 8 bands need more than 8 steps"),
    ):
        with pytest.raises(RuntimeError, match=message):
            bpy.ops.spectral_tv.caricature(**options)
    poses[1].scale.x = 0
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match="Large: its scale is zero"):
        bpy.ops.spectral_tv.caricature()
    assert all(obj.data.shape_keys is None for obj in poses)
