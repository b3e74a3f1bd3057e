"""Picking a size: a script gives it; tests/window drags it."""

from __future__ import annotations

from importlib import import_module

import bpy
import pytest
from ball import ball
from conftest import MODULE
from mathutils import Vector

sizes, ring = (import_module(f"{MODULE}.drawing.{name}") for name in ("sizes", "ring"))


@pytest.mark.parametrize("option", ["finest", "largest", "base_amount"])
def test_a_length_becomes_the_size_of_an_option(choices, option):
    obj = ball("Ball")
    length = 0.04 * sizes.size_of(obj)
    assert bpy.ops.spectral_tv.pick_size(option=option, size=length) == {"FINISHED"}
    assert getattr(choices.settings(), option) == pytest.approx(0.04, rel=1e-5)
    assert choices.use_base_amount == (option == "base_amount") != choices.use_scales


def test_what_makes_no_sense_is_refused_or_told(choices, capfd):
    with pytest.raises(RuntimeError, match="no active object"):
        bpy.ops.spectral_tv.pick_size(option="finest", size=1)
    obj = ball("Ball")
    with pytest.raises(RuntimeError, match="above 0"):
        bpy.ops.spectral_tv.pick_size(option="finest")
    bpy.ops.spectral_tv.pick_size(option="largest", size=10 * sizes.size_of(obj))
    assert "Largest goes no further than" in capfd.readouterr().out
    bpy.ops.spectral_tv.pick_size(option="largest", size=1e-3 * sizes.size_of(obj))
    assert "not below the largest" in capfd.readouterr().out


def test_the_ring_lies_on_the_surface():
    drawn = ring.Ring()
    drawn.middle, drawn.normal, drawn.radius = Vector((1, 2, 3)), Vector((0, 0.6, 0.8)), 0.5
    drawn.remove()
    for corner in drawn.corners():
        assert (corner - drawn.middle).length == pytest.approx(0.5)
        assert (corner - drawn.middle).dot(drawn.normal) == pytest.approx(0, abs=1e-6)
