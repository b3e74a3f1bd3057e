"""The panels below Deform: opened by their headers, used by their buttons, pictured."""

from __future__ import annotations

import bpy
from pictures import NEXT_HEADER, away
from screen import Steps, click, find, picture, until

# From one header of a closed panel to the next.
HEADER = 28


def others() -> Steps[None]:
    """With the dumbbell and its vertex groups active, and Deform open."""
    obj = bpy.context.object
    x, y = yield from find("spectral_tv.rig_from_pose(", column=0.3)
    below = y - NEXT_HEADER - HEADER
    yield from attributes(obj, x, below - 2 * HEADER)
    yield from segment(obj, x, below - HEADER)
    yield from caricature(obj, x, below)


def attributes(obj: bpy.types.Object, x: int, header: int) -> Steps[None]:
    settings = bpy.context.scene.spectral_tv_attributes
    settings.kind, settings.source, settings.group = "GROUP", "Head", "Head"
    settings.groups, settings.size = "Head, Feet", 60
    yield from click(x, header)
    yield from pictured("panel_attributes")
    _, y = yield from find("spectral_tv.measure_thickness(")
    yield from click(x, y - NEXT_HEADER - HEADER)  # the lower one first, which moves nothing
    yield from click(x, y - NEXT_HEADER)
    yield from pictured("panel_values")
    yield from press("spectral_tv.test_eigenset(")
    yield 2
    yield from pictured("eigenset_tested")
    yield from press("spectral_tv.flow_attribute(")
    yield from until(lambda: "Head Flow" in obj.vertex_groups, "the smoothed vertex group")
    # Last, as the picture moves what is below it out of the window.
    yield from click(*(yield from find("spectral_tv.plot_values(", column=0.3)))
    yield from until(lambda: obj.data.spectral_tv.picture is not None, "the curves")
    yield from pictured("values_plotted")
    yield from click(x, header)


def pictured(name: str) -> Steps[None]:
    yield from away()
    yield from picture(name)


def press(button: str) -> Steps[None]:
    yield from click(*(yield from find(button)))


def segment(obj: bpy.types.Object, x: int, header: int) -> Steps[None]:
    yield from click(x, header)
    yield from pictured("panel_segment")
    yield from press("spectral_tv.cosegment(")
    yield from until(lambda: len(obj.data.color_attributes) > 0, "the segments")
    yield from pictured("segmented")
    yield from click(x, header)


def caricature(obj: bpy.types.Object, x: int, header: int) -> Steps[None]:
    yield from click(x, header)
    yield from pictured("panel_caricature")
    yield from press("spectral_tv.caricature(")
    yield from until(lambda: first_band(obj) == -1, "the bands")
    yield from pictured("exaggerated")


def first_band(obj: bpy.types.Object) -> float | None:
    """Its value; None without it."""
    keys = obj.data.shape_keys
    key = None if keys is None else keys.key_blocks.get("Shape Detail Band 1")
    return None if key is None else key.value
