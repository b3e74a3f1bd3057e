"""Files of before: what they hold of bands is known."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import banded_ball
import banded_monkey
import bpy
import numpy as np
import pytest
from banded_ball import decompose, listed, names, switch, values
from banded_monkey import EXTENSION
from conftest import MODULE

banded = banded_monkey.banded
obj, keys, empty_file = banded_ball.obj, banded_ball.keys, banded_ball.empty_file


def fill_spectrum(record, kept) -> None:
    """Keep a spectrum as a collection, as older versions did."""
    for time, strength in kept.kept_spectrum:
        sample = record.spectrum.add()
        sample.time, sample.strength = time, strength


def test_bands_of_a_file_of_0_1_0_are_known(banded):
    """It kept names and digests, and no settings, on the shape keys."""
    record, kept = banded.data.shape_keys.spectral_tv, banded.data.spectral_tv.decompositions[-1]
    for name in ("identifier", "method", "area", "topology", "vertex_count", "corner_count"):
        setattr(record, name, getattr(kept, name))
    fill_spectrum(record, kept)
    for each in kept.bands:
        band = record.bands.add()
        band.key, band.digest, band.start, band.end = each.key, each.digest, each.start, each.end
    kept.bands.clear()
    for band in record.bands:
        band.property_unset("sketch")
        band.property_unset("places")
        band.property_unset("moves")
    keys = banded.data.shape_keys.key_blocks
    keys["Shape Detail Band 2"].name = "Wrinkles"
    keys["Shape Detail Band 3"].data[7].co.z += 0.1
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=4)
    assert [key.value for key in keys][1:] == [-1, -1, -1, -1]
    assert bpy.ops.spectral_tv.measure_accuracy(of_bands=True) == {"FINISHED"}
    assert "Shape Detail Error of Bands" in banded.data.attributes


def test_a_spectrum_that_is_kept_as_a_collection_is_read(banded):
    """It was so before it became one text."""
    record = banded.data.spectral_tv.decompositions[-1]
    kept = record.kept_spectrum
    picture = import_module(f"{EXTENSION}.bands.spectrum").picture
    drawn = picture(record)
    fill_spectrum(record, record)
    record.property_unset("components")
    np.testing.assert_array_equal(record.kept_spectrum, kept)
    np.testing.assert_array_equal(picture(record), drawn)
    bpy.ops.spectral_tv.decompose(bands=4, steps=12)
    assert not record.spectrum and len(record.kept_spectrum) == 11


def make_old(obj) -> None:
    """Write the record as files had it before there were several."""
    values = import_module(f"{MODULE}.scene.property_values")
    kept = obj.data.spectral_tv
    record = values.values_of(kept.decompositions[0])
    for name in ("name", "mark", "scale"):
        del record[name]
    kept.property_unset("decompositions")
    values.set_values_of(kept.decomposition, record)


def test_files_of_before_open_and_work(empty_file, obj, tmp_path: Path):
    make_old(obj)
    # Appended or made by scripts, they are read as they are.
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=1, last=1)
    assert values(obj) == [-1, 0, 0] and listed(obj) == []
    path = str(tmp_path / "old.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False)
    bpy.ops.wm.open_mainfile(filepath=path)
    loaded = bpy.data.objects["Ball"]
    assert listed(loaded) == ["Shape Detail"] and not loaded.data.spectral_tv.decomposition.bands
    bpy.ops.spectral_tv.filter(preset="BAND_STOP", first=2, last=2)
    assert values(loaded) == [0, -1, 0]
    loaded.data.spectral_tv.decompositions[0].name = "Skin"
    decompose(bands=3, steps=25)
    assert names(loaded) == [f"Skin Band {band}" for band in (1, 2, 3)]
    assert values(loaded) == pytest.approx([0, -1, 0])


def test_an_old_record_is_listed_when_another_is_added(obj, keys):
    make_old(obj)
    decompose(method="M2", bands=2)
    assert listed(obj) == ["Shape Detail", "Limbs and Head"]
    switch("Shape Detail")
    bpy.ops.spectral_tv.cut(bands=2)
    assert names(obj) == [
        "Shape Detail Band 1",
        "Shape Detail Band 2",
        "Limbs and Head Band 1",
        "Limbs and Head Band 2",
    ]
