"""Deformations of handles that move: baked frames, and live."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
import spectral_tv
from deform_scene import evaluated, handle, key_positions, live_of, members, update
from mathutils import Vector
from spectral_tv.refusal import Refusal


def test_baking_gives_each_frame_its_shape(held):
    pivot = handle(held)
    scene = bpy.context.scene
    for frame, x in ((1, 0.0), (9, 0.8)):
        pivot.location.x = x
        pivot.keyframe_insert("location", frame=frame)
    scene.frame_set(4)
    for _ in range(2):  # the second replaces the first
        assert bpy.ops.spectral_tv.bake_deformation(frame_start=1, frame_end=9, step=4) == {
            "FINISHED"
        }
    assert scene.frame_current == 4
    values = [key.value for key in held.data.shape_keys.key_blocks[1:]]
    np.testing.assert_allclose(values, [0.25, 0.75, 0], atol=1e-6)
    names = [key.name for key in held.data.shape_keys.key_blocks]
    assert names == ["Basis", "Deformation 1", "Deformation 5", "Deformation 9"]
    shapes = {}
    for frame in (1, 5, 7, 9):
        scene.frame_set(frame)
        shapes[frame] = evaluated(held)
        offset = pivot.matrix_world.translation.x
        head = members(held, "Head")
        if frame != 7:
            moved = shapes[frame][head, 0] - key_positions(held, "Basis")[head, 0]
            np.testing.assert_allclose(moved, offset, atol=1e-5)
    np.testing.assert_allclose(shapes[7], (shapes[5] + shapes[9]) / 2, atol=1e-6)


def test_a_live_deformation_follows_and_settles_at_the_optimum(held):
    live = live_of(held)
    for _ in range(10):
        handle(held).location += Vector((0.05, 0, 0.02))
        bpy.context.view_layer.update()
        assert update(live)
        head = members(held, "Head")
        moved = (key_positions(held) - key_positions(held, "Basis"))[head, 0]
        np.testing.assert_allclose(moved, handle(held).location.x, atol=1e-6)
    live.settle()
    assert live.is_settled and not live.update()
    settled = key_positions(held)
    bpy.ops.spectral_tv.deform()
    mesh = spectral_tv.Mesh(key_positions(held, "Basis"), _triangles(held))
    values = [
        spectral_tv.total_variation(mesh, shape - key_positions(held, "Basis"))
        for shape in (settled, key_positions(held))
    ]
    assert values[0] == pytest.approx(values[1], rel=2e-3)


def test_a_live_deformation_ends_when_the_mesh_changes(held):
    live = live_of(held)
    update(live)
    held.data.vertices.add(1)
    with pytest.raises(Refusal, match="vertices or faces changed"):
        live.update()


def test_what_is_there_for_comparison_does_not_follow_handles(held):
    held.spectral_tv.algorithm = "HARMONIC"
    with pytest.raises(RuntimeError, match="need the algorithm Pose or Total Variation"):
        bpy.ops.spectral_tv.bake_deformation(frame_end=2)
    with pytest.raises(Refusal, match="need the algorithm Pose or Total Variation"):
        live_of(held)
    assert held.data.shape_keys is None
    bpy.ops.spectral_tv.deform()


def _triangles(obj) -> list[list[int]]:
    obj.data.calc_loop_triangles()
    return [list(triangle.vertices) for triangle in obj.data.loop_triangles]
