"""Bands that are attributes, moved by their sliders in the panel, and a map by its button."""

from __future__ import annotations

import sys
import tempfile
from importlib import import_module
from pathlib import Path

import bpy
from others import HEADER
from pictures import NEXT_HEADER, away, new_monkey
from screen import Steps, click, drag, find, in_view, key, picture, told, until

BAND = 3


def maps() -> Steps[None]:
    """Each band has a row; a slider moves the shape; undo; the look as a map in a file."""
    obj = new_monkey()
    with in_view():
        bpy.ops.spectral_tv.decompose("EXEC_DEFAULT", True, bands=4, steps=8, bands_as="ATTRIBUTES")
    assert obj.data.shape_keys is None
    yield from away()
    for band in bands():
        yield from find(path(band))
    before = points()
    yield from drag(*(yield from find(path(bands()[BAND]))), 40)
    values = [band.value for band in bands()]
    assert values[BAND] > 0.1 and values[:BAND] == [0] * BAND, values
    assert points() != before
    yield from away()
    yield from picture("attribute_bands")
    yield from key("ctrl+z")
    yield from until(lambda: bands()[BAND].value == 0 and points() == before, "undo of the slider")
    bands()[BAND].value = 1
    yield from away()
    x, y = yield from find("spectral_tv.take_bands", column=0.7)
    header = y - NEXT_HEADER - 3 * HEADER
    yield from click(x - 60, header)
    yield from away()
    yield from picture("panel_maps")
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "map.exr"
        choices = bpy.context.scene.spectral_tv_maps
        choices.filepath, choices.size = str(target), 64
        yield from away()
        yield from click(*(yield from find("spectral_tv.bake_map(")))
        yield from until(target.exists, "the map")
    assert "of its look in 64 × 64 pixels" in (yield from told())
    yield from click(x - 60, header)  # closes the panel


def bands() -> list:
    """Those of the monkey, which undo makes anew."""
    records = sys.modules["bl_ext.user_default.spectral_tv.scene.records"]
    return records.bands_of(bpy.data.objects["Suzanne"])


def path(band) -> str:
    """What Blender copies of its slider."""
    places = import_module("bl_ext.user_default.spectral_tv.scene.attribute_place")
    return places.Attributes.path(band, "value")


def points() -> list[tuple[float, ...]]:
    """Some of those that are seen."""
    graph = bpy.context.evaluated_depsgraph_get()
    seen = bpy.data.objects["Suzanne"].evaluated_get(graph).data.vertices
    return [tuple(vertex.co) for vertex in list(seen)[::97]]
