"""Undo in Sculpt Mode takes a slider back, and not the decomposition along with it."""

from __future__ import annotations

from importlib import import_module

import bpy
import pytest
from ball import ball
from conftest import MODULE

sculpt_undo = import_module(f"{MODULE}.bands.sculpt_undo")


@pytest.fixture
def sculpted():
    """A ball in Sculpt Mode that was decomposed there."""
    ball("Ball")
    bpy.ops.ed.undo_push(message="Ball")
    bpy.ops.object.mode_set(mode="SCULPT")
    bpy.ops.ed.undo_push(message="Sculpt Mode")
    assert bpy.ops.spectral_tv.decompose("EXEC_DEFAULT", True, bands=3, steps=8) == {"FINISHED"}


def keys() -> list[bpy.types.ShapeKey]:
    found = bpy.data.objects["Ball"].data.shape_keys
    return [] if found is None else found.key_blocks[1:]


def turn(band: int, value: float) -> None:
    """Move a slider, which makes no step in Sculpt Mode."""
    keys()[band].value = value
    bpy.context.view_layer.update()


def test_a_slider_at_rest_is_a_step_of_its_own(sculpted):
    turn(0, 0.25)
    turn(0, 0.5)
    assert bpy.app.timers.is_registered(sculpt_undo._rest)
    assert sculpt_undo.make_step() and not sculpt_undo.make_step()
    turn(2, -1)
    assert sculpt_undo.make_step()
    bpy.ops.ed.undo()
    assert [key.value for key in keys()] == [0.5, 0, 0]
    bpy.ops.ed.undo()
    assert [key.value for key in keys()] == [0, 0, 0]
    assert bpy.context.object.mode == "SCULPT"
    bpy.ops.ed.redo()
    assert [key.value for key in keys()] == [0.5, 0, 0]
    bpy.ops.ed.undo()
    bpy.ops.ed.undo()
    assert keys() == []


def test_it_watches_in_files_that_are_loaded():
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.context.scene.cycles.use_denoising = False
    assert bpy.app.handlers.depsgraph_update_post.count(sculpt_undo._notice) == 1


def test_nothing_else_makes_a_step(sculpted):
    assert not sculpt_undo.make_step()
    turn(1, 0.5)
    bpy.ops.ed.undo()  # of the decomposition, as no step was made
    assert keys() == [] and not sculpt_undo.make_step()
    bpy.ops.ed.redo()
    assert not sculpt_undo.make_step()
    bpy.ops.object.mode_set(mode="OBJECT")
    turn(1, 0.75)
    assert not sculpt_undo.make_step()
    bpy.ops.object.mode_set(mode="SCULPT")
    bpy.context.view_layer.update()
    assert not sculpt_undo.make_step()


def test_another_frame_is_no_step(sculpted):
    keys()[0].keyframe_insert("value", frame=1)
    keys()[0].value = 1
    keys()[0].keyframe_insert("value", frame=9)
    bpy.context.scene.frame_set(1)
    assert not sculpt_undo.make_step()
    bpy.context.scene.frame_set(9)
    assert keys()[0].value == 1 and not sculpt_undo.make_step()
    bpy.context.scene.frame_set(1)
