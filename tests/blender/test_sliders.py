"""The ranges of the bands' sliders."""

from __future__ import annotations

import bpy
import pytest
from ball import ball


@pytest.fixture
def bands():
    """The keys of a ball's three bands."""
    obj = ball("Ball")
    bpy.ops.spectral_tv.decompose(bands=3, steps=8)
    return obj.data.shape_keys.key_blocks[1:]


def ranges(bands) -> list[tuple[float, float]]:
    return [(band.slider_min, band.slider_max) for band in bands]


def test_they_go_from_gone_to_tripled_at_first(bands):
    assert ranges(bands) == [(-1, 2)] * 3


def test_a_filter_widens_them_as_far_as_it_has_to(bands):
    bpy.ops.spectral_tv.filter(preset="EXAGGERATE", first=2, last=2, amount=3.5)
    assert [band.value for band in bands] == [0, 3.5, 0]
    assert ranges(bands) == [(-1, 2), (-1, 4), (-1, 2)]
    bpy.ops.spectral_tv.filter(preset="EXAGGERATE", first=1, last=1, amount=-2)
    assert ranges(bands) == [(-2, 2), (-1, 4), (-1, 2)]


def test_an_end_that_was_drawn_in_stays_and_what_it_cuts_off_is_told(bands, capfd):
    bands[0].slider_max = 0.5
    bpy.ops.spectral_tv.filter(preset="EXAGGERATE", first=1, last=3, amount=99)
    assert [band.value for band in bands] == [0.5, 10, 10]
    assert "cut off at the ends of the sliders: " in capfd.readouterr().out


def test_the_button_widens_them_and_draws_them_in_again(bands):
    assert bpy.ops.spectral_tv.widen_sliders() == {"FINISHED"}
    assert ranges(bands) == [(-10, 10)] * 3
    bands[1].value, bands[2].value = 4.5, -3.2
    assert bpy.ops.spectral_tv.widen_sliders() == {"FINISHED"}
    assert ranges(bands) == [(-1, 2), (-1, 5), (-4, 2)]
    assert bands[1].value == 4.5 and bands[2].value == pytest.approx(-3.2)
