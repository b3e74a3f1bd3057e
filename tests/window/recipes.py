"""A recipe by its button, and undo of a slider in Sculpt Mode."""

from __future__ import annotations

import bpy
from pictures import away, new_monkey
from screen import Steps, click, drag, find, in_view, key, picture, until

# A drag that is slow makes several steps of undo.
MOST_STEPS = 20


def recipes() -> Steps[None]:
    """One press decomposes and dials; then the same object is dialled in Sculpt Mode."""
    new_monkey()
    bpy.ops.ed.undo_push(message="Monkey")
    yield from away()
    yield from click(*(yield from find('recipe="Stylize"', column=0.3)))
    yield from until(lambda: values() != [], "the bands of the recipe")
    assert any(values()) and monkey().data.shape_keys.key_blocks[1].name == "Stylize Band 1"
    yield from away()
    yield from picture("panel_recipes")
    yield from key("ctrl+z")
    yield from until(lambda: values() == [], "undo of the recipe")
    yield from in_sculpt_mode()


def in_sculpt_mode() -> Steps[None]:
    """Undo takes the slider back, and the decomposition only after that."""
    with in_view():
        bpy.ops.object.mode_set("EXEC_DEFAULT", True, mode="SCULPT")
        bpy.ops.spectral_tv.decompose("EXEC_DEFAULT", True, method="M1", bands=5, steps=8)
    yield from away()
    yield from drag(*(yield from find('Band 4"].value')), 40)
    yield from away()
    assert values()[3] > 0.1
    yield 1.5  # until a step is made
    yield from picture("slider_in_sculpt_mode")
    for _ in range(MOST_STEPS):
        yield from key("ctrl+z")
        if values()[3] == 0:
            break
    assert values() == [0] * 5, "undo took the decomposition along with the slider"
    assert monkey().mode == "SCULPT"
    for _ in range(MOST_STEPS):  # a drag that begins slowly has a step where it began
        yield from key("ctrl+z")
        if values() == []:
            break
    assert values() == [], "undo of the decomposition"
    bpy.ops.object.mode_set(mode="OBJECT")


def monkey() -> bpy.types.Object:
    return bpy.data.objects["Suzanne"]


def values() -> list[float]:
    """Those of the bands; without them, none at all."""
    keys = monkey().data.shape_keys
    return [] if keys is None else [band.value for band in keys.key_blocks[1:]]
