"""What a decomposition takes is told where that is worth it, and refused where it does not fit."""

from __future__ import annotations

import importlib
import math
import re

import bpy
import pytest
from conftest import MODULE
from spectral_tv.attributes.accuracy import needs
from spectral_tv.bands.settings import Settings
from spectral_tv.options import estimates

pytestmark = pytest.mark.once


def module(name):
    return importlib.import_module(f"{MODULE}.{name}")


def settings(**choices):
    return Settings(**choices)


def test_small_works_are_not_worth_a_word():
    found = settings().needs(100)
    assert found.fits
    assert found.told() is None


@pytest.mark.parametrize(
    "method", ["M1", "M2", "M3", "NAIVE", "HEAT", "LB", "DISPLACEMENT", "M2_P1"]
)
def test_large_ones_of_every_method_are_told_and_those_beyond_all_memory_refused(method):
    found = settings(method=method).needs(10**13)
    text = found.told()
    assert re.match(r"About \d+(\.\d)? GB of memory, but .* are free: take fewer", text) or (
        found.available is None and re.match(r"About \d+ h, \d+\.\d GB of memory", text)
    )


def test_options_of_other_methods_that_were_chosen_before_do_not_count():
    for method in ("M1", "M3", "LB", "DISPLACEMENT"):
        chosen = settings(method=method, eigenpairs=500, metric="BASE", accuracy=0.05)
        found = chosen.needs(10**13)
        assert found.is_least == (method in ("M1", "M3"))


def test_an_accuracy_takes_at_least_what_is_told():
    chosen = settings(accuracy=0.05)
    found = chosen.needs(10**13)
    assert found.told().startswith("At least")


def test_several_meshes_take_what_they_take_together_and_other_work_is_told_too():
    one, two = (settings().needs(*[5000] * count) for count in (1, 2))
    assert two.seconds == 2 * one.seconds
    assert two.bytes == 2 * one.bytes
    assert needs("M2", 5000, 32).seconds > 5 * one.seconds
    plain, exact = (estimates.of_values(10**7, 32, exact=exact) for exact in (False, True))
    assert exact.seconds > plain.seconds
    assert re.match(r"About \d+ (s|min|h), .* of memory|About .* are free", plain.told())


def test_what_does_not_fit_is_refused_with_advice(monkey):
    """Eigenfunctions of all vertices of a mesh that is subdivided, in a process without room."""
    modifier = monkey.modifiers.new("Finer", "SUBSURF")
    modifier.levels = 4
    bpy.ops.object.modifier_apply(modifier="Finer")
    found = settings(method="LB", eigenpairs=10_000).needs(len(monkey.data.vertices))
    if found.available is None or found.fits:
        pytest.skip("there is room for it, or the system does not tell")
    with pytest.raises(RuntimeError, match=r"takes about .* of memory, but .* fewer eigenpairs"):
        bpy.ops.spectral_tv.decompose(method="LB", eigenpairs=10_000)
    assert monkey.data.shape_keys is None
    assert math.isfinite(monkey.data.vertices[0].co.x)
