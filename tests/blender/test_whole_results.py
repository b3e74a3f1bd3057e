"""Results are written whole or not at all."""

from __future__ import annotations

from importlib import import_module

import bpy
import kinds_of_results
import numpy as np
import pytest
import spectral_tv
from conftest import MODULE
from contents import contents, differences
from kinds_of_results import VERTICES, Attribute, Group, Key
from spectral_tv.bands.settings import Settings

sphere = kinds_of_results.sphere


def test_what_fails_leaves_nothing_behind(sphere):
    whole = import_module(f"{MODULE}.scene.whole").whole
    sphere.vertex_groups.active_index = 0
    before = contents()
    with pytest.raises(ZeroDivisionError), whole(sphere):
        Group.new(sphere, "New")
        Attribute.new(sphere, "Newer")
        Key.new(sphere, "Newest")
        bpy.data.texts.new("Text")
        bpy.data.images.new("Image", 4, 4)
        sphere.vertex_groups.active_index = 1
        sphere.active_shape_key_index = 2
        raise ZeroDivisionError
    assert differences(before, contents()) == []
    sphere.shape_key_clear()
    with pytest.raises(ZeroDivisionError), whole(sphere):
        sphere.shape_key_add(name="Basis")
        raise ZeroDivisionError
    assert sphere.data.shape_keys is None


def test_keys_are_added_all_or_none(sphere):
    """Bands are worked out one by one, and any may not fit into the memory."""
    add = import_module(f"{MODULE}.scene.shape_keys").add_displacements

    def displacements():
        yield np.zeros_like(VERTICES)
        raise MemoryError

    before = contents()
    with pytest.raises(MemoryError):
        add(sphere, ["One", "Two"], displacements())
    assert differences(before, contents()) == []


def test_a_decomposition_that_fails_leaves_the_bands_that_were_there(sphere):
    bands = import_module(f"{MODULE}.bands.bands")
    adding = import_module(f"{MODULE}.bands.adding")
    whole = import_module(f"{MODULE}.scene.whole").whole
    bpy.ops.spectral_tv.decompose(bands=2, steps=6)
    before = contents()
    chosen = Settings(bands=3, steps=6, into="ADD")
    surface, arguments = bands.prepare(sphere, chosen)
    split = spectral_tv.decompose(surface.mesh, **arguments)
    with pytest.raises(ZeroDivisionError), whole(sphere):
        adding.add_bands([adding.Part(sphere, surface, arguments, split)], chosen)
        raise ZeroDivisionError
    assert differences(before, contents()) == []
