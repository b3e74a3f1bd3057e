"""What the gallery calls "as it ships" is what Blender does where nothing is chosen."""

from __future__ import annotations

from importlib import import_module

import pytest
import spectral_tv
from conftest import MODULE
from spectral_tv.bands.gains import caricature_values
from spectral_tv.bands.settings import Settings
from spectral_tv.options.declaring import keywords

from tools.gallery import shipped

CaricatureSettings = import_module(f"{MODULE}.bands.caricature").CaricatureSettings


def bands_of(settings) -> shipped.Bands:
    """What the gallery would call the bands of settings, less what is so by default."""
    options = {**settings.method_arguments(None, None), **keywords(settings)}
    method = options.pop("method")
    usual = spectral_tv.DEFAULTS
    own = {name: value for name, value in options.items() if value != usual.get(name)}
    return shipped.Bands(method, own, settings.limbs_kept)


@pytest.mark.parametrize("method", shipped.SHIPPED)
def test_bands_of_the_gallery_are_those_by_default(method):
    settings = Settings(method=method.upper())
    assert bands_of(settings) == shipped.SHIPPED[method]
    assert (settings.bands, settings.steps) == (shipped.COUNT, shipped.STEPS)


def test_caricature_of_the_gallery_is_that_by_default():
    asked = CaricatureSettings()
    assert bands_of(asked.of_bands()) == shipped.CARICATURE
    values = caricature_values(asked.bands, asked.first, asked.last, asked.amount, asked.smooth)
    assert tuple(values) == shipped.AMOUNTS
