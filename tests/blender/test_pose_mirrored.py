"""Pose of mirrored objects: each half has its bodies, and those that meet on the plane are one."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from ball import object_of
from deform_scene import constrain, empty, group, handle, key_positions, members
from shapes import dumbbell

VERTICES, FACES = dumbbell(n_around=24, n_along=60)
VERTICES[np.abs(VERTICES[:, 0]) < 1e-9, 0] = 0


def hold(obj, region: np.ndarray, place: tuple[float, float, float]) -> None:
    vertices = np.array([vertex.co for vertex in obj.data.vertices], dtype=float)
    group(obj, "Feet", np.flatnonzero(vertices[:, 2] < -0.9))
    group(obj, "Held", np.flatnonzero(region))
    constrain(obj, "Feet", "PIN")
    constrain(obj, "Held", "OBJECT", target=empty(place))


@pytest.fixture
def half():
    """The half of a dumbbell at positive X, with Mirror."""
    faces = FACES[(VERTICES[FACES, 0] >= 0).all(axis=1)]
    kept, faces = np.unique(faces, return_inverse=True)
    obj = object_of("Half", VERTICES[kept], faces.reshape(-1, 3))
    obj.modifiers.new("Mirror", "MIRROR")
    return obj, VERTICES[kept]


def rigid(before: np.ndarray, after: np.ndarray) -> tuple[np.ndarray, float]:
    one, other = (points - points.mean(axis=0) for points in (before, after))
    left, _, right = np.linalg.svd(other.T @ one)
    matrix = left @ np.diag([1, 1, np.linalg.det(left @ right)]) @ right
    return matrix, float(np.abs(other - one @ matrix.T).max())


def test_a_group_on_the_plane_is_one_body_that_stays_on_it(half):
    obj, vertices = half
    hold(obj, vertices[:, 2] > 1.8, (0, 0, 2))
    handle(obj).location = (0.3, 0.6, 1.8)
    bpy.context.view_layer.update()
    bpy.ops.spectral_tv.deform()
    basis, shape = key_positions(obj, "Basis"), key_positions(obj)
    np.testing.assert_allclose(shape[basis[:, 0] == 0, 0], 0, atol=1e-6)
    held = members(obj, "Held")
    both = [np.concatenate([points, points * (-1, 1, 1)]) for points in (basis[held], shape[held])]
    matrix, misfit = rigid(*both)
    assert misfit < 1e-5
    np.testing.assert_allclose(matrix[0], (1, 0, 0), atol=1e-5)  # it nods
    assert matrix[2, 1] < -0.2


def test_the_result_is_that_of_the_whole(half):
    obj, vertices = half
    whole = object_of("Whole", VERTICES, FACES)
    for each, points in ((obj, vertices), (whole, VERTICES)):
        bpy.context.view_layer.objects.active = each
        hold(each, points[:, 2] > 1.8, (0, 0, 2))
        handle(each).location = (0, 0.6, 1.8)
        bpy.context.view_layer.update()
        bpy.ops.spectral_tv.deform()
    basis = key_positions(whole, "Basis")
    for point, place in zip(key_positions(obj, "Basis"), key_positions(obj), strict=True):
        index = np.argmin(np.linalg.norm(basis - point, axis=1))
        assert np.linalg.norm(key_positions(whole)[index] - place) < 0.02


def test_a_group_off_the_plane_is_a_body_of_each_half(half):
    obj, vertices = half
    hold(obj, (vertices[:, 0] > 0.9) & (vertices[:, 2] > 0), (1, 0, 1.2))
    handle(obj).location = (0.9, 0.3, 1.5)
    bpy.context.view_layer.update()
    bpy.ops.spectral_tv.deform()
    basis, shape = key_positions(obj, "Basis"), key_positions(obj)
    held = members(obj, "Held")
    _, misfit = rigid(basis[held], shape[held])
    assert misfit < 1e-5
    np.testing.assert_allclose((shape - basis)[held].mean(axis=0), (-0.1, 0.3, 0.3), atol=1e-5)
    np.testing.assert_allclose(shape[basis[:, 0] == 0, 0], 0, atol=1e-6)
