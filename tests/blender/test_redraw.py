"""Panels are drawn at every move of a slider, so that they read nothing large."""

from __future__ import annotations

from importlib import import_module

import bpy
import pytest
from ball import ball
from conftest import MODULE

from tools.bench import sliders_process

records = import_module(f"{MODULE}.scene.records")


@pytest.mark.parametrize("into", ["REPLACE", "ADD"])
def test_bands_are_recognised_anew_only_when_names_change(into, monkeypatch):
    obj = ball("Ball")
    bpy.ops.spectral_tv.decompose(bands=3, steps=8)
    bpy.context.scene.spectral_tv.into = into
    panels = sliders_process._open_panels()
    assert {panel.bl_label for panel in panels} >= {"Recipes", "Decompose", "Bands", "Filters"}
    asked = []
    recognise = records.recognise_all
    monkeypatch.setattr(records, "recognise_all", lambda obj: asked.append(obj) or recognise(obj))

    def draw() -> int:
        asked.clear()
        for panel in panels:
            sliders_process._draw(panel)
        return len(asked)

    draw()
    obj.data.shape_keys.key_blocks[1].value = 0.5
    assert draw() == 0
    obj.data.shape_keys.key_blocks[1].name = "Skin"
    assert draw() == 1 and draw() == 0
