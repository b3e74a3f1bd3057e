"""Names of results: nobody else's, cut between letters, and ones that Blender takes."""

from __future__ import annotations

from importlib import import_module

import bpy
import kinds_of_results
import numpy as np
import pytest
from conftest import MODULE
from contents import contents, differences
from kinds_of_results import FEW, VERTICES, Attribute, Group, Key, each_kind, flow
from spectral_tv.refusal import Refusal

sphere = kinds_of_results.sphere


def test_groups_and_attributes_do_not_take_each_others_names(sphere):
    Group.new(sphere, "Mask Flow")
    Attribute.new(sphere, "Cap Flow")
    flow(**Attribute.source, size=5, **FEW)
    flow(**Group.source, size=5, **FEW)
    assert "Mask Flow.001" in sphere.data.attributes and "Mask Flow" not in sphere.data.attributes
    assert "Cap Flow.001" in sphere.vertex_groups and "Cap Flow" not in sphere.vertex_groups
    flow(**Attribute.source, result="BANDS", bands=2, steps=8)
    assert {"Mask Band 1", "Mask Band 2", "Mask Rest"} <= set(sphere.data.attributes.keys())


@each_kind
@pytest.mark.parametrize("letter", ["x", "é", "形", "🙂"])
def test_long_names_keep_what_the_result_is(sphere, kind, letter):
    """Cut between letters, however many bytes one has."""
    source = letter * (63 // len(letter.encode()))
    kind.all(sphere)[kind.source["source"]].name = source
    for _ in range(2):
        flow(kind=kind.source["kind"], source=source, size=5, **FEW)
    flow(kind=kind.source["kind"], source=source, result="BANDS", bands=2, steps=8)
    bands = kind if kind is Key else Attribute
    flowed, one, two, rest = (
        [each.name for each in all_of if each.name.startswith(letter) and each.name.endswith(end)]
        for end, all_of in (
            (" Flow", kind.all(sphere)),
            *((each, bands.all(sphere)) for each in (" Band 1", " Band 2", " Rest")),
        )
    )
    assert len(flowed) == len(one) == len(two) == len(rest) == 1
    for name in (*flowed, *one, *two, *rest):
        assert len(name.encode()) <= 63 and set(name.split(" ")[0]) == {letter}


def test_bands_of_a_mesh_with_a_long_name_are_numbered(sphere):
    sphere.name = "s" * 63
    for name in ("A" * 63, "B" * 63):
        sphere.shape_key_add(name=name)
    bpy.ops.spectral_tv.measure_accuracy(bands=2, steps=8)
    assert sphere.data.spectral_tv.accuracy is not None


@pytest.mark.parametrize("name", ["material_index", "sharp_edge", "uv_seam"])
def test_a_name_that_blender_refuses_is_told_and_nothing_is_written(sphere, name):
    """Some attributes can be of one type alone; of another they would end some versions."""
    results = import_module(f"{MODULE}.scene.results")
    pieces = {
        label: results.Piece("ATTRIBUTE", np.zeros(len(VERTICES)), "FLOAT")
        for label in ("fine", name)
    }
    before = contents()
    with pytest.raises(Refusal, match=name):
        results.write(sphere, "TEST", "", pieces, wanted=lambda _source, label: (label, ""))
    assert differences(before, contents()) == []
