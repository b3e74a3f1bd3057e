"""Handles that turn: the pieces at them do not, and that is told; algorithms say what they are."""

from __future__ import annotations

import math
import re
from importlib import import_module

import bpy
import numpy as np
import pytest
from conftest import MODULE
from deform_scene import constrain, empty, handle, key_positions, members

TOLD = "without turning them, Pose and As Rigid as Possible turn them"


def constraints():
    return import_module("spectral_tv.deformation.settings")


def turn(obj, degrees: float) -> None:
    handle(obj).rotation_euler.y = math.radians(degrees)
    bpy.context.view_layer.update()


def turned(obj) -> float:
    """By how many degrees the upper ball beyond the handle's group was turned."""
    before, after = key_positions(obj, "Basis"), key_positions(obj)
    beyond = (before[:, 2] > 0.8) & (before[:, 2] < 1.7)
    one, other = (points[beyond] - points[beyond].mean(axis=0) for points in (before, after))
    left, _, right = np.linalg.svd(other.T @ one)
    return math.degrees(math.acos(min((np.trace(left @ right) - 1) / 2, 1)))


def test_what_turns_and_what_does_not_is_as_told(held, capfd):
    turn(held, 60)
    angles = {}
    held.spectral_tv.constraints[1].turns = True
    for name, label, *_ in constraints().ALGORITHMS:
        if not name:  # a heading
            continue
        bpy.ops.spectral_tv.deform(algorithm=name)
        angles[name] = turned(held)
        told = capfd.readouterr().out
        expected = f"handles are turned by up to 60°: {label} moves the pieces at them {TOLD}"
        assert (expected in told) == (name not in constraints().TURNING)
    assert angles["CONVEX"] < 10
    assert all(angles[name] > 25 for name in constraints().TURNING)


@pytest.mark.parametrize("degrees", [3, 8, 170])
def test_small_turns_are_not_worth_a_word(held, capfd, degrees):
    turn(held, degrees)
    bpy.ops.spectral_tv.deform()
    told = capfd.readouterr().out
    assert (f"turned by up to {degrees}°" in told) == (degrees > 5)


def test_turns_are_against_the_object_and_in_the_world(held, capfd):
    """A handle and the object that turn together turn nothing."""
    for obj in (held, handle(held)):
        obj.rotation_euler.x = 1
    held.scale.z = 2
    held.spectral_tv.constraints[1].target = handle(held)
    for obj in (held, handle(held)):
        obj.rotation_euler.x = 0
        obj.location = (1, 2, 3)
    handle(held).location = (0, 0, 0)
    bpy.ops.spectral_tv.deform()
    assert "turned" not in capfd.readouterr().out


def test_a_turn_on_the_way_is_told_by_baking(held, capfd):
    expression = "0.1 * (frame if frame < 8 else 16 - frame)"
    handle(held).driver_add("rotation_euler", 1).driver.expression = expression
    bpy.ops.spectral_tv.bake_deformation(frame_start=1, frame_end=15, step=7)
    told = capfd.readouterr().out
    assert f"turned by up to {math.degrees(0.8):.0f}°" in told
    bpy.context.scene.frame_set(1)


def test_a_shape_key_that_turns_a_group_is_told(body, capfd):
    body.shape_key_add(name="Basis")
    turned_key = body.shape_key_add(name="Nod")
    turned_key.value = 0
    angle = math.radians(40)
    for index in members(body, "Head"):
        x, y, z = turned_key.data[index].co
        turned_key.data[index].co = (
            x * math.cos(angle) + z * math.sin(angle), y, z * math.cos(angle) - x * math.sin(angle)
        )  # fmt: skip
    constrain(body, "Feet", "PIN")
    constrain(body, "Head", "KEY", shape_key="Nod")
    bpy.ops.spectral_tv.deform()
    assert "turned by up to 40°" in capfd.readouterr().out


def test_the_panel_sees_the_same_without_evaluating(held):
    turning = import_module(f"{MODULE}.deformation.turning")
    turn(held, 60)
    assert turning.of_handles(held) == pytest.approx(60, abs=1e-3)
    assert "60°" in turning.told(60.0, "CONVEX")
    assert turning.told(60.0, "ARAP") is None
    constrain(held, "Head", "OBJECT")
    constrain(held, "Head", "OBJECT", target=empty(), bone="Nothing")
    assert turning.of_handles(held) == pytest.approx(60, abs=1e-3)


def test_how_far_the_papers_algorithm_is_from_the_optimum_is_told(held, capfd):
    """It does not claim to be the same, as where handles turn it ends far off."""
    (paper,) = (each for each in constraints().ALGORITHMS if each[0] == "PAPER")
    assert "same" not in paper[2]
    handle(held).location.x += 0.5
    bpy.ops.spectral_tv.deform(algorithm="PAPER")
    assert re.search(r"deformed to within \d\.\d+% of the optimum", capfd.readouterr().out)
    turn(held, 60)
    bpy.ops.spectral_tv.deform(algorithm="PAPER")
    told = capfd.readouterr().out
    assert "of the optimum" not in told
    found = re.search(r"up to (\d+)% of the total variation could be spared", told)
    assert found and int(found[1]) > 10
    assert "ended away from the optimum, which Total Variation finds" in told
