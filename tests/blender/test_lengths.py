"""The sidebar shows sizes as lengths of the active object; they are kept relative to its size."""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module

import bpy
import numpy as np
import pytest
from ball import ball, object_of
from conftest import MODULE
from spectral_tv.bands.settings import Settings

sizes = import_module(f"{MODULE}.drawing.sizes")
NAMES = ("finest", "largest", "base_amount", "weld")


def scaled(obj, *factors: float) -> None:
    obj.scale = factors
    bpy.context.view_layer.update()


def test_the_size_is_that_of_the_decomposition():
    obj = ball("Ball")
    scaled(obj, 2, 2, 3)
    bpy.ops.spectral_tv.decompose(bands=2, steps=6)
    area = obj.data.spectral_tv.decompositions[-1].area
    assert sizes.size_of(obj) == pytest.approx(np.sqrt(area), rel=1e-5)


def test_lengths_are_relative_sizes_of_the_active_object(choices):
    obj = ball("Ball")
    choices.use_scales = choices.use_base_amount = True
    for factor in (1, 10):
        scaled(obj, factor, factor, factor)
        size = sizes.size_of(obj)
        for name, percent in zip(NAMES, (2, 20, 5, 0.5), strict=True):
            setattr(choices, name, percent)
            assert getattr(choices, f"length_{name}") == pytest.approx(percent / 100 * size)
    choices.length_finest, choices.length_weld = 0.03 * size, 0.002 * size
    own = Settings(finest=0.03, largest=0.2, base_amount=0.05, weld=0.2)
    found = choices.settings()
    for name in NAMES:
        assert getattr(found, name) == pytest.approx(getattr(own, name), rel=1e-5)
    scaled(obj, 1, 1, 1)
    assert choices.length_finest == pytest.approx(0.03 * sizes.size_of(obj), rel=1e-5)
    assert replace(found, weld=0, finest=0) == replace(choices.settings(), weld=0, finest=0)


def test_lengths_beyond_what_options_take_are_cut_off(choices):
    obj = ball("Ball")
    choices.use_scales = True
    choices.length_finest, choices.length_largest = 0, 1e6
    assert choices.finest == pytest.approx(0.01) and choices.largest == pytest.approx(100)
    assert choices.length_largest == pytest.approx(sizes.size_of(obj))


def test_without_an_object_there_are_no_lengths(choices):
    bpy.context.view_layer.objects.active = None
    choices.use_scales = True
    choices.finest = 3
    choices.length_finest = 7
    assert sizes.size_of_active() is None
    assert choices.finest == 3 and choices.length_finest == 0
    flat = object_of("Line", [[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]])
    assert sizes.size_of(flat) is None


def test_a_mesh_is_measured_once_and_again_when_it_was_changed(monkeypatch):
    obj = ball("Ball")
    first = sizes.size_of(obj)
    vertices = obj.data.vertices
    vertices.foreach_set("co", 2 * np.array([v.co for v in vertices], np.float32).ravel())
    assert sizes.size_of(obj) == first  # Blender has not told of it so far
    obj.data.update()
    bpy.context.view_layer.update()
    assert sizes.size_of(obj) == first  # until it is at rest
    monkeypatch.setattr(sizes, "REST", 0)
    assert sizes.size_of(obj) == pytest.approx(2 * first, rel=1e-5)


def test_a_shape_that_makes_a_new_object_has_no_lengths(choices):
    ball("Ball")
    assert choices.object_size() is not None
    choices.shape = "APPLIED"
    assert choices.object_size() is None
    assert not bpy.ops.spectral_tv.pick_size.poll()


def test_the_other_half_of_a_mirror_counts():
    obj = ball("Ball")
    alone = sizes.size_of(obj)
    mirror = obj.modifiers.new("Mirror", "MIRROR")
    mirror.use_mirror_merge = False
    bpy.ops.spectral_tv.decompose(bands=2, steps=6)
    area = obj.data.spectral_tv.decompositions[-1].area
    assert sizes.size_of(obj) == pytest.approx(np.sqrt(area), rel=1e-5)
    assert sizes.size_of(obj) == pytest.approx(np.sqrt(2) * alone, rel=1e-5)
