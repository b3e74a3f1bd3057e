"""At Once: what follows a change of settings, and undo of both; tests/window does it by mouse.

Without a window nothing follows by itself, so a change is told and followed here by hand.
"""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module

import bpy
import pytest
from ball import ball, object_of
from conftest import MODULE
from shapes import icosphere
from spectral_tv.bands.settings import Settings

at_once, at_once_plan, whole_change, bands = (
    import_module(f"{MODULE}.bands.{name}")
    for name in ("at_once", "at_once_plan", "whole_change", "bands")
)
STEPS = 10


@pytest.fixture
def choices():
    scene = bpy.context.scene
    found = scene.spectral_tv
    found.fill(replace(Settings(), bands=3, steps=STEPS))
    found.at_once = True
    yield found
    found = bpy.context.scene.spectral_tv  # undo makes others
    found.fill(Settings())
    for name in ("at_once", "change", "finest", "largest", "base_amount"):
        found.property_unset(name)
    at_once.forget()


def choose(choices, **options) -> bool:
    """Set options as a user does; the change is a step of undo, and so are the bands."""
    for name, value in options.items():
        setattr(choices, name, value)
    follows = at_once.take(bpy.context.scene, *options)
    bpy.ops.ed.undo_push(message="Change")
    at_once.follow()
    return follows


def records(obj) -> list:
    return list(obj.data.spectral_tv.decompositions)


def made(obj) -> Settings:
    return bands.settings_of(records(obj)[0])


def waiting(obj, choices, *changed: str) -> str | None:
    return at_once_plan.waiting(obj, choices.settings(), changed, is_new=False)


def test_bands_follow_the_settings_and_keep_the_look(choices):
    obj = ball("Ball")
    bpy.ops.spectral_tv.decompose(method="M1", bands=3, steps=STEPS)
    for key in obj.data.shape_keys.key_blocks[1:]:
        key.value = 0.5
    obj.data.spectral_tv_limbs.keep = 2
    for options in ({"steps": 12}, {"soft_edges": 0.5}, {"use_scales": True, "largest": 5}):
        before = records(obj)[0].identifier
        assert choose(choices, **options)
        (record,) = records(obj)
        assert record.identifier != before
        assert [key.value for key in obj.data.shape_keys.key_blocks[1:]] == [0.5] * 3
        assert obj.data.spectral_tv_limbs.keep == 2
    assert (made(obj).steps, made(obj).soft_edges) == (12, 0.5)
    assert made(obj).largest == pytest.approx(0.05)
    assert choose(choices, method="M2")
    (record,) = records(obj)
    assert record.method == "M2" and record.name == "Limbs and Head"


def test_another_number_of_bands_is_a_cut_alone(choices):
    obj = ball("Ball")
    bpy.ops.spectral_tv.decompose(method="M1", bands=3, steps=STEPS)
    before = records(obj)[0].identifier
    assert choose(choices, bands=5)
    assert len(records(obj)[0].bands) == 5 and records(obj)[0].identifier == before
    assert not choose(choices, bands=5)  # it is so
    obj.data.spectral_tv_count.bands = 4  # beside the bands, which stays
    assert choose(choices, steps=12)
    assert len(records(obj)[0].bands) == 4


def test_an_object_without_bands_follows_only_when_the_switch_is_turned_on(choices):
    obj = ball("Ball")
    assert not choose(choices, steps=12) and not records(obj)
    assert choose(choices, at_once=True)
    assert made(obj).steps == 12
    other = ball("Other")
    assert not choose(choices, steps=14) and not records(other)


def test_nothing_follows_while_the_switch_is_off(choices):
    obj = ball("Ball")
    bpy.ops.spectral_tv.decompose(method="M1", bands=3, steps=STEPS)
    choices.at_once = False
    assert not choose(choices, steps=12)
    assert made(obj).steps == STEPS


def test_nothing_follows_by_itself_without_a_window(choices):
    obj = ball("Ball")
    bpy.ops.spectral_tv.decompose(method="M1", bands=3, steps=STEPS)
    choices.steps = 12
    assert not at_once.is_active() and made(obj).steps == STEPS
    assert choices.change == ""


def test_an_object_with_other_settings_is_left_alone_until_they_are_taken(choices):
    """The sidebar has settings of one object; another one was made by others."""
    other = ball("Other")
    bpy.ops.spectral_tv.decompose(method="M2", bands=4, steps=9)
    ball("Ball")
    bpy.ops.spectral_tv.decompose(method="M1", bands=3, steps=STEPS)
    bpy.context.view_layer.objects.active = other
    assert not choose(choices, soft_edges=0.6)
    assert "was made with another Method, Steps" in waiting(other, choices)
    assert made(other) == replace(made(other), method="M2", steps=9)
    assert bpy.ops.spectral_tv.take_settings() == {"FINISHED"}
    assert waiting(other, choices) is None
    assert (choices.method, choices.steps, choices.bands) == ("M2", 9, 4)
    assert choose(choices, steps=11) and made(other).steps == 11


def test_what_it_waits_for(choices):
    obj = ball("Ball")
    bpy.ops.spectral_tv.decompose(method="M1", bands=3, steps=STEPS)
    assert waiting(obj, choices) is None
    assert "need more than" in at_once_plan.waiting(
        obj, replace(choices.settings(), bands=20), ("bands",), is_new=False
    )
    shape = replace(choices.settings(), shape="APPLIED")
    assert "new object" in at_once_plan.waiting(obj, shape, ("shape",), is_new=False)
    bpy.ops.object.mode_set(mode="SCULPT")
    assert "Object Mode" in waiting(obj, choices)
    assert not choose(choices, steps=12)
    bpy.ops.object.mode_set(mode="OBJECT")
    records(obj)[0].is_part = True  # as after a file with two objects of one surface was loaded
    bands.flows.clear()
    assert "several objects" in waiting(obj, choices)
    records(obj)[0].is_part = False
    obj.data.vertices.add(1)
    assert "changed since" in waiting(obj, choices)
    assert waiting(None, choices) == "There is no active object"


def test_undo_takes_a_change_and_its_bands_back_at_once(choices):
    obj = ball("Ball")
    bpy.ops.spectral_tv.decompose("EXEC_DEFAULT", True, method="M1", bands=3, steps=STEPS)
    for steps in (12, 14):
        choose(choices, steps=steps)
    for expected in (12, STEPS):
        bpy.ops.ed.undo()
        while whole_change.step_on(is_undo=True):
            pass
        obj, choices = bpy.data.objects["Ball"], bpy.context.scene.spectral_tv
        assert (choices.steps, made(obj).steps) == (expected, expected)
    for expected in (12, 14):
        bpy.ops.ed.redo()
        while whole_change.step_on(is_undo=False):
            pass
        obj, choices = bpy.data.objects["Ball"], bpy.context.scene.spectral_tv
        assert (choices.steps, made(obj).steps) == (expected, expected)


def test_undo_of_something_else_does_not_go_on(choices):
    ball("Ball")
    bpy.ops.spectral_tv.decompose("EXEC_DEFAULT", True, method="M1", bands=3, steps=STEPS)
    choose(choices, steps=12)
    bpy.context.object.location.x = 3
    bpy.ops.ed.undo_push(message="Move")
    bpy.ops.ed.undo()
    assert not whole_change.step_on(is_undo=True)
    assert bpy.context.object.location.x == 0
    assert made(bpy.context.object).steps == 12


def test_undo_stops_at_what_was_done_meanwhile(choices, monkeypatch):
    """A step between the change and its bands is one of its own."""
    ball("Ball")
    bpy.ops.spectral_tv.decompose("EXEC_DEFAULT", True, method="M1", bands=3, steps=STEPS)
    choices.steps = 12
    at_once.take(bpy.context.scene, "steps")
    bpy.ops.ed.undo_push(message="Change")
    run = at_once._run

    def moving(stage):
        bpy.context.object.location.x = 3
        bpy.ops.ed.undo_push(message="Move")
        return run(stage)

    monkeypatch.setattr(at_once, "_run", moving)
    at_once.follow()
    assert made(bpy.context.object).steps == 12
    bpy.ops.ed.undo()
    assert not whole_change.step_on(is_undo=True)
    assert made(bpy.context.object).steps == STEPS
    assert bpy.context.object.location.x == 3


def test_a_change_that_a_newer_one_replaced_goes_along(choices):
    ball("Ball")
    bpy.ops.spectral_tv.decompose("EXEC_DEFAULT", True, method="M1", bands=3, steps=STEPS)
    choices.steps = 11
    at_once.take(bpy.context.scene, "steps")
    bpy.ops.ed.undo_push(message="Change")
    choose(choices, steps=12)
    bpy.ops.ed.undo()
    while whole_change.step_on(is_undo=True):
        pass
    assert bpy.context.scene.spectral_tv.steps == STEPS == made(bpy.context.object).steps


def test_small_meshes_have_no_preview(choices):
    obj = ball("Ball")
    found = at_once_plan.plan(obj, choices.settings(), {"steps"})
    assert [stage.is_preview for stage in found.stages] == [False] and not found.told


def limits(monkeypatch, obj, preview: Settings, whole: Settings, longest: float) -> None:
    """Have so much time that the preview is prompt and the whole is not."""
    least, most = (each.needs(len(obj.data.vertices)).seconds for each in (preview, whole))
    assert least < most
    monkeypatch.setattr(at_once_plan, "PROMPT", (least + most) / 2)
    monkeypatch.setattr(at_once_plan, "LONGEST", longest * most)


def test_what_takes_longer_has_a_preview_first(choices, monkeypatch):
    obj = ball("Ball")
    settings = replace(choices.settings(), steps=64)
    limits(monkeypatch, obj, replace(settings, steps=8), settings, longest=2)
    found = at_once_plan.plan(obj, settings, {"steps"})
    assert [stage.is_preview for stage in found.stages] == [True, False]
    assert [stage.settings.steps for stage in found.stages] == [8, 64]
    assert not found.told


def test_what_takes_too_long_is_left_to_the_button(choices, monkeypatch):
    obj = ball("Ball")
    settings = replace(choices.settings(), steps=1000)
    limits(monkeypatch, obj, replace(settings, steps=8), settings, longest=0.9)
    found = at_once_plan.plan(obj, settings, {"steps"})
    assert [stage.is_preview for stage in found.stages] == [True]
    assert found.told.startswith("A preview with 8 steps is shown. Press the button for all 1000")
    waves = replace(settings, method="LB", eigenpairs=1000)  # which take no steps
    monkeypatch.setattr(at_once_plan, "PROMPT", 0)
    monkeypatch.setattr(at_once_plan, "LONGEST", 0)
    found = at_once_plan.plan(obj, waves, {"steps"})
    assert not found.stages and found.told.startswith("Press the button for that")


def test_a_preview_is_bands_of_fewer_steps_and_then_gives_way(choices, monkeypatch):
    """With limits so low that a ball has a preview."""
    obj = object_of("Ball", icosphere(3)[0] * [1, 1.2, 1.5], icosphere(3)[1])
    choose(choices, at_once=True)
    whole = replace(choices.settings(), steps=40)
    limits(monkeypatch, obj, replace(whole, steps=8), whole, longest=2)
    seen = []
    written = at_once._written
    monkeypatch.setattr(
        import_module(f"{MODULE}.bands.decompose"),
        "WRITTEN",
        [written, lambda obj, settings: seen.append((settings.steps, choices.change[-9:]))],
    )
    assert choose(choices, steps=40)
    assert seen == [(8, "previewed"), (40, seen[1][1])] and seen[1][1].endswith("done")
    assert made(obj).steps == 40 and len(records(obj)) == 1
    bpy.ops.ed.undo()
    while whole_change.step_on(is_undo=True):
        pass
    assert made(bpy.context.object).steps == STEPS == bpy.context.scene.spectral_tv.steps
