"""What is kept of a decomposition: the flow that bands are cut from again, and its spectrum."""

from __future__ import annotations

from importlib import import_module
from itertools import groupby

import banded_monkey
import bpy
import numpy as np
import pytest
from banded_monkey import EXTENSION, shape
from spectral_tv.bands.settings import Settings

banded = banded_monkey.banded


def test_cutting_again_uses_the_same_flow(banded):
    keys = banded.data.shape_keys.key_blocks
    total = sum(shape(key) - shape(keys[0]) for key in list(keys)[1:])
    extra = banded.shape_key_add(name="Smile", from_mix=False)
    bpy.ops.spectral_tv.cut(bands=6)
    assert [key.name for key in keys] == [
        "Basis",
        *(f"Shape Detail Band {i}" for i in range(1, 7)),
        extra.name,
    ]
    again = sum(shape(key) - shape(keys[0]) for key in list(keys)[1:7])
    np.testing.assert_allclose(again, total, atol=1e-5)
    bpy.ops.spectral_tv.filter(preset="RESET")
    with pytest.raises(RuntimeError, match="number of bands"):
        bpy.ops.spectral_tv.cut(bands=12)


def test_the_flow_is_recalled_until_the_shape_or_the_steps_change(banded):
    bands = import_module(f"{EXTENSION}.bands.bands")

    bands.flows.clear()  # those of other tests
    bpy.ops.spectral_tv.decompose(bands=4, steps=12)

    def is_recalled(**choices) -> bool:
        return bands.recall(*bands.prepare(banded, Settings(**choices))) is not None

    assert is_recalled(bands=4, steps=12)
    assert is_recalled(bands=7, steps=12)
    assert not is_recalled(bands=4, steps=13)
    assert not is_recalled(bands=4, steps=12, method="M2")
    banded.data.shape_keys.key_blocks["Basis"].data[5].co.x += 1e-3
    assert not is_recalled(bands=4, steps=12)


def test_the_spectrum_shows_the_bands_from_left_to_right(banded):
    spectrum = import_module(f"{EXTENSION}.bands.spectrum")
    record = banded.data.spectral_tv.decompositions[-1]
    bottom = [tuple(pixel) for pixel in spectrum.picture(record)[0]]
    colors = [tuple(np.float32(spectrum.color(band, 4))) for band in range(4)]
    seen = [pixel for pixel in bottom if pixel in colors]
    assert [pixel for pixel, _ in groupby(seen)] == colors
    assert spectrum.icon(record) == spectrum.icon(record)
