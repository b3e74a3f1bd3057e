"""Deformations of surfaces whose vertices are not those of the mesh: mirrored, joined."""

from __future__ import annotations

import math

import bpy
import numpy as np
import pytest
from ball import object_of
from deform_scene import constrain, empty, evaluated, group, handle, key_positions, members
from shapes import dumbbell


def mesh_object(vertices, faces) -> bpy.types.Object:
    obj = object_of("Mesh", vertices, faces)
    obj.spectral_tv.algorithm = "CONVEX"
    return obj


def hold(obj, vertices) -> None:
    """Its lower end pinned, its upper end following an empty."""
    group(obj, "Feet", np.flatnonzero(vertices[:, 2] < -0.9))
    group(obj, "Head", np.flatnonzero(vertices[:, 2] > 1.8))
    constrain(obj, "Feet", "PIN")
    constrain(obj, "Head", "OBJECT", target=empty((0, 0, 2)))


@pytest.fixture
def half():
    """The half of a dumbbell at positive X, with Mirror."""
    vertices, faces = dumbbell(n_around=24, n_along=60)
    vertices[np.abs(vertices[:, 0]) < 1e-9, 0] = 0
    faces = faces[(vertices[faces, 0] >= 0).all(axis=1)]
    kept, faces = np.unique(faces, return_inverse=True)
    vertices = vertices[kept]
    obj = mesh_object(vertices, faces.reshape(-1, 3))
    obj.modifiers.new("Mirror", "MIRROR")
    hold(obj, vertices)
    return obj


def moved(obj) -> np.ndarray:
    return key_positions(obj) - key_positions(obj, "Basis")


def test_of_a_mirrored_object_both_halves_are_held_and_the_midline_stays(half, capfd):
    count = len(evaluated(half))
    handle(half).location = (0.3, 0.4, 2)
    bpy.ops.spectral_tv.deform()
    assert "the other half of 'Mirror' is held and moved likewise" in capfd.readouterr().out
    basis = key_positions(half, "Basis")
    is_middle = basis[:, 0] == 0
    head, feet = members(half, "Head"), members(half, "Feet")
    side = head[~is_middle[head]]
    np.testing.assert_allclose(moved(half)[side], np.tile([0.3, 0.4, 0], (len(side), 1)), atol=1e-5)
    np.testing.assert_allclose(moved(half)[feet], 0, atol=1e-5)
    np.testing.assert_allclose(moved(half)[is_middle, 0], 0, atol=1e-6)
    middle = head[is_middle[head]]
    np.testing.assert_allclose(moved(half)[middle, 1], 0.4, atol=1e-5)
    assert len(evaluated(half)) == count  # no seam has opened


def test_of_a_mirrored_object_the_result_is_that_of_the_whole(half):
    """Along the plane of symmetry."""
    handle(half).location.y = 0.5
    bpy.ops.spectral_tv.deform()
    shape = key_positions(half)
    vertices, faces = dumbbell(n_around=24, n_along=60)
    whole = mesh_object(vertices, faces)
    hold(whole, vertices)
    handle(whole).location.y = 0.5
    bpy.ops.spectral_tv.deform()
    basis = key_positions(whole, "Basis")
    for point, place in zip(key_positions(half, "Basis"), shape, strict=True):
        index = np.argmin(np.linalg.norm(basis - point, axis=1))
        assert np.linalg.norm(key_positions(whole)[index] - place) < 0.02


def test_turns_of_a_mirrored_object_are_those_of_its_own_half(half, capfd):
    handle(half).rotation_euler.z = math.radians(30)
    bpy.ops.spectral_tv.deform()
    assert "turned by up to 30°" in capfd.readouterr().out


def test_corners_that_are_joined_follow_a_turned_handle_as_one():
    """Every triangle has corners of its own, some of them a little apart."""
    vertices, faces = dumbbell(n_around=24, n_along=60)
    soup = vertices[faces].reshape(-1, 3)
    soup += np.random.default_rng(0).normal(0, 1e-6, soup.shape)
    obj = mesh_object(soup, np.arange(len(soup)).reshape(-1, 3))
    hold(obj, soup)
    bpy.context.scene.spectral_tv.weld = 0.01
    handle(obj).rotation_euler.z = 0.5
    handle(obj).location.x = 0.3
    bpy.ops.spectral_tv.deform()
    bpy.context.scene.spectral_tv.property_unset("weld")
    head = members(obj, "Head")
    turn = np.array(handle(obj).matrix_world)[:3, :3]
    expected = (soup[head] - (0, 0, 2)) @ turn.T + (0.3, 0, 2)
    np.testing.assert_allclose(key_positions(obj)[head], expected, atol=1e-4)
    apart = np.linalg.norm(key_positions(obj)[:, None][:300] - key_positions(obj)[None], axis=2)
    together = np.linalg.norm(soup[:, None][:300] - soup[None], axis=2) < 1e-4
    assert apart[together].max() < 1e-3
