"""Bands of another method in the place of the active ones."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from ball import ball, object_of
from shapes import dumbbell

SMALL = {"bands": 3, "steps": 8}
METHODS = ("M1", "M2", "M3", "NAIVE", "HEAT", "LB", "DISPLACEMENT", "M2_P2")


def decompose(method: str, **options) -> None:
    options = {**SMALL, "into": "REPLACE_ANY", "eigenpairs": 12, **options}
    assert bpy.ops.spectral_tv.decompose(method=method, **options) == {"FINISHED"}


def shapes(obj) -> np.ndarray:
    keys = obj.data.shape_keys.key_blocks
    return np.array([[list(point.co) for point in key.data] for key in keys])


def names(obj) -> list[str]:
    return [key.name for key in obj.data.shape_keys.key_blocks[1:]]


def test_any_method_replaces_any_other():
    obj = ball("Ball")
    for method in (*METHODS, *reversed(METHODS), "M2", "LB", "M1"):
        decompose(method)
        (record,) = obj.data.spectral_tv.decompositions
        assert record.method == method
        assert len(names(obj)) == len(record.bands) == (1 if method == "DISPLACEMENT" else 3)
        assert names(obj) == [f"{record.name} Band {n + 1}" for n in range(len(record.bands))]
    assert names(obj)[0] == "Shape Detail Band 1"


def test_they_are_what_they_would_be_if_they_were_added():
    obj = ball("Ball")
    decompose("M1")
    for key in obj.data.shape_keys.key_blocks[1:]:
        key.value = -0.5  # which is no part of what is decomposed
    decompose("M2")
    again = ball("Again")
    decompose("M2")
    assert np.abs(shapes(obj) - shapes(again)).max() < 1e-6


def test_gains_of_the_same_sizes_go_over():
    obj = ball("Ball")
    scales = {"use_scales": True, "finest": 2, "largest": 20}
    decompose("M1", **scales)
    for key, value in zip(obj.data.shape_keys.key_blocks[1:], (0.25, -1, 1.5), strict=True):
        key.value = value
    decompose("HEAT", **scales)
    found = [key.value for key in obj.data.shape_keys.key_blocks[1:]]
    assert found == pytest.approx([0.25, -1, 1.5])


def test_a_name_of_the_user_stays():
    obj = ball("Ball")
    decompose("M1")
    obj.data.spectral_tv.decompositions[0].name = "Skin"
    decompose("M2")
    assert obj.data.spectral_tv.decompositions[0].name == "Skin"
    assert names(obj)[0] == "Skin Band 1"


def test_a_key_of_the_user_with_the_name_of_the_new_bands_stays():
    obj = ball("Ball")
    decompose("M1")
    obj.shape_key_add(name="Limbs and Head Band 1")
    decompose("M2")
    assert names(obj).count("Limbs and Head Band 1") == 1
    assert obj.data.spectral_tv.decompositions[0].name == "Limbs and Head 2"


def test_objects_of_one_surface_go_together():
    vertices, triangles = dumbbell(neck_length=3.0)
    upper = (vertices[triangles][:, :, 2] > 0).all(axis=1)
    parts = [object_of(str(part), vertices, triangles[part]) for part in (upper, ~upper)]
    for obj in parts:
        obj.select_set(True)
    bpy.ops.spectral_tv.decompose(**SMALL, together=True)
    assert all(obj.data.spectral_tv.decompositions[0].is_part for obj in parts)
    decompose("M2")
    assert [obj.data.spectral_tv.decompositions[0].method for obj in parts] == ["M2", "M2"]
    used = [np.isin(np.arange(len(vertices)), triangles[part]) for part in (upper, ~upper)]
    seam = used[0] & used[1]
    one, two = (shapes(obj)[:, seam] for obj in parts)
    assert seam.any() and np.abs(one - two).max() < 1e-6
