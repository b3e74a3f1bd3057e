"""Sizes of bands: relative to the object, and the method's own where none are chosen."""

from __future__ import annotations

from dataclasses import replace

import bpy
import numpy as np
import pytest
import spectral_tv


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
