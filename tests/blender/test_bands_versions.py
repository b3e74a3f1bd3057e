"""Files of before: their bands and spectra are known."""

from __future__ import annotations

from importlib import import_module

import banded_monkey
import bpy
import numpy as np
from banded_monkey import EXTENSION

banded = banded_monkey.banded


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
