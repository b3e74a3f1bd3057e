"""Which vertices a set or constraints mean: truth values, or indices; never one for the other."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv
from shapes import icosphere

VERTICES, TRIANGLES = icosphere(2)
MESH = spectral_tv.Mesh(VERTICES, TRIANGLES)
COUNT = len(VERTICES)
CAP = VERTICES[:, 2] > 0.5
EXPECTED = spectral_tv.eigenset_test(MESH, CAP)


@pytest.mark.parametrize(
    "members",
    [
        CAP.astype(int),
        CAP.astype(np.uint8),
        CAP.astype(int).tolist(),
        CAP.astype(float),
        CAP.astype(np.float32),
        np.where(CAP, 0.5, 0.49),
        CAP.tolist(),
        np.flatnonzero(CAP),
        np.flatnonzero(CAP).tolist(),
        np.flatnonzero(CAP)[::-1].astype(np.uint16),
    ],
)
def test_truth_values_of_any_type_and_indices_mean_the_same_set(members):
    found = spectral_tv.eigenset_test(MESH, members)
    assert (found.area, found.perimeter) == (EXPECTED.area, EXPECTED.perimeter)
    np.testing.assert_array_equal(found.superset, EXPECTED.superset)


def test_two_indices_are_a_set_of_two_vertices():
    found = spectral_tv.eigenset_test(MESH, [0, 1])
    assert found.area == pytest.approx(MESH.vertex_areas[:2].sum())


@pytest.mark.parametrize(
    ("members", "message"),
    [
        ([5, 9, 7, 9], "the index 9 twice, in places 1 and 3"),
        ([0, 1, 1, 0], r"the index 1 twice, .* 0 or 1, for each of the 162"),
        (CAP.astype(int)[1:], r"twice, .* for each of the 162"),
        (np.where(CAP, 2, 0), r"twice, .* as of members == 1"),
        (np.where(CAP, 255, 0).astype(np.uint8), "twice|index 255"),
        (np.where(CAP, 1, -1), "the index -1, but the vertices are 0 to 161"),
        ([162], "the index 162"),
        (CAP[1:], r"161 truth values, but there are 162 vertices"),
        (CAP[:, np.newaxis], "must be a list of numbers"),
        (CAP.astype(float)[1:], r"one value per vertex \(162\), but has 161"),
        (np.where(CAP, np.nan, 1), r"members\[0\] is not a number|members\[\d+\] is not a number"),
        (np.ones(COUNT, bool), "no boundary"),
        (np.zeros(COUNT, int), "no boundary"),
        ([], "no boundary"),
        (CAP.astype(str), "members must be an array of numbers"),
    ],
)
def test_what_is_no_set_of_these_vertices_is_refused(members, message):
    with pytest.raises(spectral_tv.MeshError, match=message):
        spectral_tv.eigenset_test(MESH, members)


@pytest.mark.parametrize("mask", [np.abs(VERTICES[:, 2]) > 0.8])
def test_constraints_are_indices_or_a_mask(mask):
    indices = np.flatnonzero(mask)
    targets = VERTICES[mask] + np.where(VERTICES[mask, 2:] > 0, 1, 0) * [0.3, 0, 0]
    expected = spectral_tv.deform(MESH, indices, targets).vertices
    for meant in (mask, mask.tolist(), mask.astype(int)):
        found = spectral_tv.deform(MESH, meant, targets)
        np.testing.assert_array_equal(found.vertices, expected)
        deformer = spectral_tv.Deformer(MESH, meant)
        np.testing.assert_array_equal(deformer.solve(targets).vertices, expected)
    with pytest.raises(spectral_tv.MeshError, match="indices has 161 truth values"):
        spectral_tv.Deformer(MESH, mask[1:])
    with pytest.raises(spectral_tv.MeshError, match=r"one target per .* \(\d+\), not 162"):
        spectral_tv.deform(MESH, mask, VERTICES)


def test_constraints_may_name_a_vertex_twice():
    """Several springs pull at one vertex."""
    ends = np.array([0, 9, 9, 40])
    targets = VERTICES[ends] + [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0]]
    found = spectral_tv.deform(MESH, ends, targets, np.full(4, 0.9))
    assert found.gap < 1e-3
