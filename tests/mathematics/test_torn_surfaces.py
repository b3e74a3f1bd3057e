"""Surfaces whose corners are not joined are decomposed as the whole ones they are pieces of."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import spectral_tv
from shapes import bumpy_sphere, grid
from torn import beside, cube_of_sides, half_grids, noisy_soup, relief, soup

WHOLE = bumpy_sphere(3)
METHODS = ["m1", "m2", "m3"]


def bands(mesh, method):
    split = spectral_tv.decompose(mesh, method, steps=12)
    return np.concatenate([split.bands(split.band_edges(4)), split.residual[np.newaxis]])


@pytest.mark.parametrize("method", [*METHODS, "naive", "heat", "lb"])
def test_a_soup_has_the_bands_of_the_joined_mesh(method):
    expected = bands(spectral_tv.Mesh(*WHOLE), method)
    joined = spectral_tv.Mesh(*soup(WHOLE), weld=0)
    assert len(joined.vertices) == len(WHOLE[0])
    found = bands(joined, method)[:, joined.weld_map]
    np.testing.assert_allclose(found, expected[:, WHOLE[1].ravel()], atol=1e-10)


@pytest.mark.parametrize("method", METHODS)
def test_differently_rounded_corners_are_one(method):
    expected = bands(spectral_tv.Mesh(*WHOLE), method)
    joined = spectral_tv.Mesh(*noisy_soup(WHOLE, 1e-7), weld=1e-6)
    assert len(joined.vertices) == len(WHOLE[0])
    found = bands(joined, method)[:, joined.weld_map]
    np.testing.assert_allclose(found, expected[:, WHOLE[1].ravel()], atol=1e-5)


@pytest.mark.parametrize("method", METHODS)
def test_a_cube_of_sides_stays_closed(method):
    vertices, triangles = cube_of_sides()
    joined = spectral_tv.Mesh(vertices, triangles, weld=0)
    assert (len(joined.vertices), joined.findings.open_edges) == (8, 0)
    np.testing.assert_array_equal(joined.vertices[joined.weld_map], vertices)
    corners, places = np.unique(vertices, axis=0, return_inverse=True)
    expected = bands(spectral_tv.Mesh(corners, places.ravel()[triangles]), method)
    found = bands(joined, method)[:, joined.weld_map]
    np.testing.assert_allclose(found, expected[:, places.ravel()], atol=1e-10)


@pytest.mark.parametrize("method", METHODS)
def test_halves_with_a_gap_are_one_surface(method):
    vertices, triangles = half_grids(17, 17, 1e-6)
    joined = spectral_tv.Mesh(vertices, triangles, weld=2e-6)
    assert joined.findings.components == 1
    whole, faces = grid(17, 17, 2.0)
    whole = relief(whole)
    expected = bands(spectral_tv.Mesh(whole, faces), method)
    same = np.r_[: 9 * 17, 8 * 17 : 17 * 17]
    np.testing.assert_allclose(vertices, whole[same], atol=1.1e-6)
    found = bands(joined, method)[:, joined.weld_map]
    np.testing.assert_allclose(found, expected[:, same], atol=2e-5)


def conforming(rows, other_rows):
    """The half-grids with the first one's triangles split at the other's border by hand."""
    vertices, triangles = half_grids(rows, other_rows, 0.0)
    count = 9 * rows
    ours, theirs = np.arange(count - rows, count), np.arange(count, count + other_rows)
    place = np.arange(len(vertices))
    place[ours] = theirs[:: (other_rows - 1) // (rows - 1)]
    whole = []
    for triangle in place[triangles]:
        at_border = np.isin(triangle, theirs)
        if at_border.sum() != 2 or (triangle >= count).all():
            whole.append(triangle)
            continue
        turned = np.roll(triangle, -(np.flatnonzero(~at_border)[0] + 1))
        chain = np.arange(min(turned[:2]), max(turned[:2]) + 1)
        chain = chain if turned[0] < turned[1] else chain[::-1]
        whole += [[start, end, turned[2]] for start, end in pairwise(chain)]
    return vertices, np.array(whole), place


def off_the_edges(moved):
    """How far the border of the fine grid is from the straight edges of the coarse one."""
    ours, theirs = moved[72:81], moved[81 : 81 + 33]
    edge = np.minimum(np.arange(33) // 4, 7)
    start, way = ours[edge], np.diff(ours, axis=0)[edge]
    share = ((theirs - start) * way).sum(axis=1) / (way * way).sum(axis=1)
    nearest = start + np.clip(share, 0.0, 1.0)[:, np.newaxis] * way
    return np.linalg.norm(theirs - nearest, axis=1)


@pytest.mark.parametrize("gap", [0.0, 1e-6])
@pytest.mark.parametrize("method", METHODS)
def test_no_gap_opens_between_a_coarse_and_a_fine_grid(method, gap):
    vertices, triangles = half_grids(9, 33, gap)
    joined = spectral_tv.Mesh(vertices, triangles, weld=2e-6)
    assert (joined.findings.closed_junctions, joined.findings.joined_corners) == (24, 18)
    assert joined.findings.components == 1
    split = spectral_tv.decompose(joined, method, steps=12)
    shapes, faces, place = conforming(9, 33)
    expected = spectral_tv.decompose(spectral_tv.Mesh(shapes, faces), method, steps=12)
    used = np.unique(place)
    for gains in (np.zeros(11), np.repeat([0.0, 1.0], [6, 5]), np.repeat([2.0, 1.0], [6, 5])):
        moved = split.filter(gains)[joined.weld_map]
        tolerance = 2e-5 if gap else 1e-9
        np.testing.assert_allclose(moved[used], expected.filter(gains)[used], atol=tolerance)
        # A screen shows the coarse triangles as they were, an eighth long, with straight edges.
        off = off_the_edges(moved)
        assert off[::4].max() < 1e-15
        assert off.max() < (0.015 if method == "m3" else 0.01)
    with pytest.warns(spectral_tv.MeshWarning, match="36 % of 112 open edges nearly touch"):
        torn = spectral_tv.Mesh(vertices, triangles)
    moved = spectral_tv.decompose(torn, method, steps=12).residual
    assert off_the_edges(moved)[::4].max() > 0.01


@pytest.mark.parametrize("weld", [0, 1e-3])
def test_surfaces_that_merely_touch_stay_apart(weld):
    """Two balls that have a point in common, and do not know of it, are two."""
    vertices, triangles = WHOLE
    touching = np.argmax(vertices[:, 0])
    vertices = vertices - vertices[touching]
    both = beside((vertices, triangles), (-vertices, triangles))
    joined = spectral_tv.Mesh(*both, weld=weld)
    assert not joined.findings
    np.testing.assert_array_equal(joined.weld_map, np.arange(len(both[0])))
    moves = bands(joined, "m1")[:-1].sum(axis=0)
    assert np.linalg.norm(moves[touching] - moves[touching + len(vertices)]) > 1e-3


def test_layers_farther_apart_than_the_tolerance_stay_apart():
    cloth, triangles = grid(9, 9)
    layers = beside((cloth, triangles), (cloth + np.array([0.0, 0.0, 0.02]), triangles))
    apart = spectral_tv.Mesh(*layers, weld=0.01)
    assert (apart.findings.joined_corners, apart.findings.components) == (0, 2)
    together = spectral_tv.Mesh(*layers, weld=0.03)
    assert (together.findings.joined_corners, together.findings.components) == (64, 1)
