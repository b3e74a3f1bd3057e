"""bpy.ops.spectral_tv.test_eigenset says what a vertex group is."""

from __future__ import annotations

from importlib import import_module

import bpy
import numpy as np
import pytest
import spectral_tv
from ball import object_of
from conftest import MODULE
from shapes import dumbbell

VERTICES, FACES = dumbbell(n_around=32, n_along=64)


@pytest.fixture
def obj():
    obj = object_of("Dumbbell", VERTICES, FACES)
    for name, height in (("Half", 0), ("Ball", 0.9)):
        members = np.flatnonzero(VERTICES[:, 2] > height).tolist()
        obj.vertex_groups.new(name=name).add(members, 1, "REPLACE")
    return obj


def members(obj, name) -> np.ndarray:
    index = obj.vertex_groups[name].index
    return np.array([any(m.group == index for m in v.groups) for v in obj.data.vertices])


def test_an_eigenset_changes_nothing(obj):
    assert bpy.ops.spectral_tv.test_eigenset(group="Half") == {"FINISHED"}
    assert [group.name for group in obj.vertex_groups] == ["Half", "Ball"]


def test_the_better_set_is_written_once(obj):
    for _ in range(2):
        bpy.ops.spectral_tv.test_eigenset(group="Ball")
    assert [group.name for group in obj.vertex_groups] == ["Half", "Ball", "Ball Superset"]
    superset = members(obj, "Ball Superset")
    assert superset[members(obj, "Ball")].all()
    assert VERTICES[superset, 2].min() < 0.6


def test_the_verdict_is_in_words():
    verdict = import_module(f"{MODULE}.attributes.eigenset").verdict
    mesh = spectral_tv.Mesh(VERTICES, FACES)
    half = verdict("Half", spectral_tv.eigenset_test(mesh, VERTICES[:, 2] > 0))
    assert half.startswith("'Half' is an eigenset: ")
    assert "in a straight line (R² 1.0000), as a whole" in half
    assert half.endswith("no larger set that was tried has a smaller perimeter")
    ball = verdict("Ball", spectral_tv.eigenset_test(mesh, VERTICES[:, 2] > 0.9))
    assert ball.startswith("'Ball' is no eigenset: ")
    assert "not in a straight line" in ball and "which is not that rate" in ball
    assert "a larger set has" in ball


def test_refusals(obj):
    obj.vertex_groups.new(name="Empty")
    for group, message in (("Nothing", "no vertex group 'Nothing'"), ("Empty", "no boundary")):
        with pytest.raises(RuntimeError, match=message):
            bpy.ops.spectral_tv.test_eigenset(group=group)
