"""Surfaces torn along seams, as files with texture coordinates or flat shading hold them."""

from __future__ import annotations

import bmesh
import bpy
import numpy as np
import pytest


def shape(key) -> np.ndarray:
    flat = np.empty(3 * len(key.data), dtype=np.float32)
    key.data.foreach_get("co", flat)
    return flat.reshape(-1, 3)


def bands(obj) -> np.ndarray:
    """Displacements of the bands' shape keys, (K, V, 3)."""
    basis, *keys = obj.data.shape_keys.key_blocks
    return np.array([shape(key) - shape(basis) for key in keys])


def positions(obj) -> np.ndarray:
    return np.array([vertex.co for vertex in obj.data.vertices])


def rough_ball() -> bpy.types.Object:
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4)
    obj = bpy.context.object
    scales = 1 + 0.05 * np.random.default_rng(3).normal(size=len(obj.data.vertices))
    for vertex, scale in zip(obj.data.vertices, scales, strict=True):
        vertex.co *= scale
    return obj


def tear(obj, edges) -> None:
    """Split the edges for which ``edges`` is true of their middle."""
    split = bmesh.new()
    split.from_mesh(obj.data)
    chosen = [edge for edge in split.edges if edges((edge.verts[0].co + edge.verts[1].co) / 2)]
    bmesh.ops.split_edges(split, edges=chosen)
    split.to_mesh(obj.data)
    split.free()


@pytest.mark.parametrize(
    "edges", [lambda middle: abs(middle.x) < 0.1, lambda _: True], ids=["a seam", "every edge"]
)
def test_torn_surfaces_have_the_bands_of_whole_ones(edges):
    whole = rough_ball()
    bpy.ops.spectral_tv.decompose(bands=3, steps=8)
    places = {tuple(place): index for index, place in enumerate(positions(whole))}
    torn = rough_ball()
    tear(torn, edges)
    assert len(torn.data.vertices) > len(whole.data.vertices)
    same = [places[tuple(place)] for place in positions(torn)]
    bpy.ops.spectral_tv.decompose(bands=3, steps=8)
    for count in (3, 4):
        for obj in (whole, torn):
            bpy.context.view_layer.objects.active = obj
            bpy.ops.spectral_tv.cut(bands=count)
        np.testing.assert_array_equal(bands(torn), bands(whole)[:, same])
    assert len(torn.data.vertices) == len(same)


def test_seams_stay_closed():
    torn = rough_ball()
    tear(torn, lambda _: True)
    _, together = np.unique(positions(torn), axis=0, return_inverse=True)
    bpy.ops.spectral_tv.decompose(bands=3, steps=8)
    for key in torn.data.shape_keys.key_blocks:
        assert len(np.unique(shape(key), axis=0)) == together.max() + 1


def test_shape_keys_serve_as_base_of_torn_surfaces():
    ball = rough_ball()
    results = []
    for _ in range(2):
        ball.shape_key_add(name="Basis")
        smooth = ball.shape_key_add(name="Smooth", from_mix=False)
        for point in smooth.data:
            point.co.normalize()
        bpy.ops.spectral_tv.decompose(method="M3", bands=2, steps=8, base="KEY", base_key="Smooth")
        lengths = np.sort(np.linalg.norm(bands(ball)[-1], axis=1))
        results.append(lengths[[0, -1]])
        ball.shape_key_clear()
        tear(ball, lambda middle: abs(middle.x) < 0.1)
    np.testing.assert_allclose(results[0], results[1], atol=2e-5)


def test_surfaces_that_merely_touch_stay_apart():
    """Two closed balls in one mesh with a vertex at the same place move on their own."""
    one, other = rough_ball(), rough_ball()
    for obj, side in ((one, 1), (other, -1)):
        farthest = max(obj.data.vertices, key=lambda vertex: vertex.co.x * side)
        shift = farthest.co.copy()
        for vertex in obj.data.vertices:
            vertex.co -= shift
    bpy.ops.spectral_tv.decompose(bands=3, steps=8)
    alone = bands(other)
    other.shape_key_clear()
    one.select_set(True)
    other.select_set(True)
    bpy.context.view_layer.objects.active = other
    bpy.ops.object.join()
    both = positions(other)
    assert len(np.unique(both, axis=0)) == len(both) - 1

    touching = np.flatnonzero((both == 0).all(axis=1))
    bpy.ops.spectral_tv.decompose(bands=3, steps=8)
    moves = bands(other)[:, touching].sum(axis=0)
    assert np.abs(moves[0] - moves[1]).max() > 1e-3
    assert len(bands(other)[0]) == 2 * len(alone[0])
