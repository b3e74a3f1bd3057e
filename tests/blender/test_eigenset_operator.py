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
from spectral_tv.notes import gathered

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


def test_elements_are_chosen_and_told(obj):
    told = {}
    for choice in ("AUTOMATIC", "EDGES", "VERTICES"):
        chosen = import_module("spectral_tv.attributes.settings").chosen_elements(
            choice, members(obj, "Half").astype(float)
        )
        found = spectral_tv.eigenset_test(
            spectral_tv.Mesh(VERTICES, FACES), members(obj, "Half"), elements=chosen
        )
        told[choice] = chosen, found.rate
        assert bpy.ops.spectral_tv.test_eigenset(group="Half", elements=choice) == {"FINISHED"}
    assert told["AUTOMATIC"] == told["EDGES"]
    assert told["EDGES"][0] == "edges" and told["VERTICES"][0] == "vertices"
    assert told["EDGES"][1] != told["VERTICES"][1]
    kept = bpy.ops.spectral_tv.test_eigenset.get_rna_type().properties["elements"]
    assert kept.default == "AUTOMATIC"


def test_a_set_on_a_large_mesh_is_told_to_flow_on_vertices():
    settings = import_module("spectral_tv.attributes.settings")
    with gathered() as notes:
        large = (np.arange(250_001) < 9).astype(float)[:, np.newaxis]
        assert settings.chosen_elements("AUTOMATIC", large) == "vertices"
        assert settings.chosen_elements("EDGES", large) == "edges"
        settings.chosen_elements("AUTOMATIC", np.linspace(0, 1, 250_001)[:, np.newaxis])
    assert len(notes) == 1 and "250001" in notes[0]


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
