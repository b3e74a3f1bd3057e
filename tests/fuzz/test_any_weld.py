"""Whatever the mesh and the tolerance, joining keeps its promises."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
import spectral_tv
from hypothesis import given, reject
from hypothesis import strategies as st
from nasty_meshes import meshes
from torn import canonical, open_edges

TOLERANCES = [0.0, 1e-12, 1e-8, 1e-4, 1e-2, 0.1, 1.0, 100.0]


@st.composite
def torn_meshes(draw):
    """A mesh with some of its corners unjoined, and then a little off; a tolerance."""
    vertices, triangles = draw(meshes())
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    size = np.ptp(vertices, axis=0).max()
    own = rng.random(triangles.shape) < draw(st.sampled_from([0.0, 0.1, 0.5, 1.0]))
    extra = triangles[own]
    triangles = triangles.copy()
    triangles[own] = len(vertices) + np.arange(len(extra))
    noise = draw(st.sampled_from([0.0, 1e-9, 1e-5, 1e-2])) * size
    more = vertices[extra] + noise * rng.uniform(-1, 1, (len(extra), 3))
    if draw(st.booleans()):  # a corner somewhere on an edge
        ends = vertices[triangles[:, 0] % len(vertices)], vertices[triangles[:, 1] % len(vertices)]
        share = rng.random((len(triangles), 1))
        some = rng.random(len(triangles)) < 0.2
        middle = ((1 - share) * ends[0] + share * ends[1])[some]
        first = len(vertices) + len(more)
        fins = np.column_stack([first + np.arange(len(middle)), triangles[some][:, 1:]])
        triangles = np.vstack([triangles, fins])
        more = np.vstack([more, middle])
    return np.vstack([vertices, more]), triangles, draw(st.sampled_from(TOLERANCES)) * size


def welded(vertices, triangles, weld):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", spectral_tv.MeshWarning)
        try:
            return spectral_tv.Mesh(vertices, triangles, weld=weld)
        except spectral_tv.MeshError:
            reject()


def areas(vertices, triangles):
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def faces(triangles):
    return sorted(map(tuple, np.sort(triangles, axis=1).tolist()))


@given(torn_meshes())
def test_the_map_leads_to_the_mesh(case):
    vertices, triangles, weld = case
    mesh = welded(*case)
    place = mesh.weld_map
    assert len(place) == len(vertices)
    np.testing.assert_array_equal(np.unique(place), np.arange(len(mesh.vertices)))
    first = np.unique(place, return_index=True)[1]
    assert (np.diff(first) > 0).all()
    count = mesh.findings.closed_junctions
    assert len(mesh.triangles) == len(triangles) + count
    if count == 0:
        np.testing.assert_array_equal(mesh.triangles, place[triangles])
    members = np.bincount(place)
    assert mesh.findings.joined_corners == (members[place] > 1).sum()
    at_border = np.unique(open_edges(triangles))
    assert mesh.findings.border_corners == len(at_border)
    assert np.isin(np.flatnonzero(members[place] > 1), at_border).all()
    if weld == 0:
        np.testing.assert_array_equal(mesh.vertices[place], vertices)


@given(torn_meshes())
def test_fewer_edges_are_open_than_before(case):
    _, triangles, _ = case
    mesh = welded(*case)
    left = open_edges(mesh.triangles)
    assert len(left) == mesh.findings.open_edges
    assert mesh.findings.open_edges_before == len(open_edges(triangles))
    assert len(left) <= mesh.findings.open_edges_before


@given(torn_meshes())
def test_no_triangle_collapses_that_had_three_places(case):
    vertices, triangles, _ = case
    mesh = welded(*case)
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    had = ((a != b).any(axis=1)) & ((b != c).any(axis=1)) & ((c != a).any(axis=1))
    a, b, c = mesh.weld_map[triangles].T
    assert ((a != b) & (b != c) & (c != a))[had].all()
    a, b, c = mesh.triangles[len(triangles) :].T
    assert ((a != b) & (b != c) & (c != a)).all()


@given(torn_meshes())
def test_joining_once_is_enough(case):
    mesh = welded(*case)
    again = welded(mesh.vertices, mesh.triangles, case[2])
    assert not again.findings
    np.testing.assert_array_equal(again.vertices, mesh.vertices)
    np.testing.assert_array_equal(again.triangles, mesh.triangles)


@given(torn_meshes(), st.integers(0, 2**32 - 1))
def test_the_order_does_not_matter(case, seed):
    vertices, triangles, weld = case
    mesh = welded(*case)
    rng = np.random.default_rng(seed)
    order = rng.permutation(len(vertices))
    shuffled = np.argsort(order)[triangles][rng.permutation(len(triangles))]
    turn = rng.integers(0, 3, len(shuffled))
    shuffled = np.take_along_axis(shuffled, (np.arange(3) + turn[:, None]) % 3, axis=1)
    other = welded(vertices[order], shuffled, weld)
    place = np.empty(len(vertices), dtype=np.int64)
    place[order] = other.weld_map
    np.testing.assert_array_equal(canonical(place), canonical(mesh.weld_map))
    np.testing.assert_array_equal(other.vertices[place] + 0.0, mesh.vertices[mesh.weld_map] + 0.0)
    same = np.empty(len(mesh.vertices), dtype=np.int64)
    same[mesh.weld_map] = place
    assert faces(same[mesh.triangles]) == faces(other.triangles)


@given(torn_meshes())
def test_the_area_changes_by_the_tolerance_along_the_border(case):
    vertices, triangles, weld = case
    mesh = welded(*case)
    at_border = np.isin(triangles, open_edges(triangles)).any(axis=1)
    a, b, c = vertices[triangles[at_border]].transpose(1, 0, 2)
    length = sum(np.linalg.norm(p - q, axis=1).sum() for p, q in ((a, b), (b, c), (c, a)))
    change = areas(mesh.vertices, mesh.triangles).sum() - areas(vertices, triangles).sum()
    size = areas(vertices, triangles).sum()
    assert abs(change) <= 3 * weld * length + 1e-9 * size


@given(torn_meshes(), st.sampled_from(["m1", "m2", "m3"]))
def test_bands_add_up_to_the_joined_shape(case, method):
    mesh = welded(*case)
    split = spectral_tv.decompose(mesh, method, steps=5)
    bands = split.bands([0, *split.times[1:-1] * (1 + 1e-9), np.inf])
    assert np.isfinite(bands).all()
    scale = np.abs(bands).sum() + np.abs(split.residual).max()
    np.testing.assert_allclose(
        bands.sum(axis=0) + split.residual, mesh.vertices, rtol=0, atol=1e-12 * scale
    )


@given(torn_meshes())
def test_advice_that_is_given_helps(case):
    vertices, triangles, _ = case
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            spectral_tv.Mesh(vertices, triangles)
    except spectral_tv.MeshError:
        return
    advice = [str(warning.message).split("pass weld=") for warning in caught]
    advice = [float(parts[1]) for parts in advice if len(parts) == 2 and parts[1][0].isdigit()]
    for weld in advice:
        found = welded(vertices, triangles, weld).findings
        assert found.open_edges < found.open_edges_before


def test_a_row_of_dust_is_not_drawn_together():
    """Each grain is near the next, but only neighbours become one."""
    grain = np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.5, 0.0]])
    row = np.vstack([grain + np.array([0.0, 0.0, 0.01 * k]) for k in range(50)])
    with pytest.warns(spectral_tv.MeshWarning):
        mesh = spectral_tv.Mesh(row, np.arange(150).reshape(-1, 3), weld=0.011)
    extent = [np.ptp(row[mesh.weld_map == k], axis=0).max() for k in range(len(mesh.vertices))]
    assert max(extent) <= 0.05
