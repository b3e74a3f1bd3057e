"""The preferences of the extension: its tab, and its research tools."""

from __future__ import annotations

from importlib import import_module

import bpy
import pytest
from ball import ball
from conftest import MODULE

PARTS = ("accuracy", "values", "eigenset")


def preferences() -> bpy.types.AddonPreferences:
    return bpy.context.preferences.addons[MODULE].preferences


@pytest.fixture(autouse=True)
def _as_before():
    yield
    preferences().tab, preferences().research_tools = "Spectral TV", False


def panels() -> list[type]:
    every = import_module(f"{MODULE}.registration")._panels()
    assert len(every) > 15
    return every


def test_the_tab_has_another_name_at_once():
    order = [cls.__name__ for cls in panels()]
    preferences().tab = "Item"
    assert {cls.bl_category for cls in panels()} == {"Item"}
    assert [cls.__name__ for cls in panels()] == order
    assert all(cls.is_registered for cls in panels())
    preferences().tab = "  "
    assert {cls.bl_category for cls in panels()} == {"Spectral TV"}


def test_the_tab_is_there_when_the_extension_is_enabled_again():
    preferences().tab = "Sculpting"
    package = import_module(MODULE)
    package.unregister()
    try:
        assert not hasattr(bpy.types, "SPECTRAL_TV_PT_bands")
    finally:
        package.register()
    assert bpy.types.SPECTRAL_TV_PT_bands.bl_category == "Sculpting"


def test_research_tools_are_shown_where_they_are_asked_for():
    ball("Ball")
    bpy.ops.spectral_tv.decompose(bands=3, steps=8)
    classes = [getattr(bpy.types, f"SPECTRAL_TV_PT_{part}") for part in PARTS]
    assert not any(cls.poll(bpy.context) for cls in classes)
    preferences().research_tools = True
    assert all(cls.poll(bpy.context) for cls in classes)


def test_recipes_come_first():
    first, *others = panels()
    assert first.__name__ == "SPECTRAL_TV_PT_recipes"
    assert all(getattr(cls, "bl_order", 0) >= getattr(first, "bl_order", 0) for cls in others)
