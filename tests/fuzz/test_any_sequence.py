"""Whatever the moving targets: finite deformations that meet each of them, or a refusal."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv
from hypothesis import given
from hypothesis import strategies as st
from nasty_meshes import meshes
from patience import result
from test_any_deformation import assert_deformed, pulls
from test_any_mesh import made
from test_any_value import MESH, arrays, refusable


@given(
    st.data(),
    meshes(),
    st.sampled_from([0.0, 0.1]),
    st.lists(st.floats(-3, 3), min_size=1, max_size=4),
)
def test_any_sequence_is_followed(data, corrupt, softness, shares):
    mesh = made(*corrupt)
    vertices = corrupt[0]
    indices, targets, weights = data.draw(pulls(vertices))
    indices, first = np.unique(indices, return_index=True)
    start, pull, weights = vertices[indices], targets[first] - vertices[indices], weights[first]
    try:
        deformer = spectral_tv.Deformer(mesh, indices, weights, softness * mesh.area**0.5)
    except spectral_tv.MeshError as error:
        assert "nothing is left" in str(error)
        return
    sequence = [start + share * pull for share in shares]
    for moved, bent in zip(
        sequence, result(deformer.start_solve_sequence(sequence, 1e-2)), strict=True
    ):
        assert_deformed(bent, vertices, indices, moved, weights)


@given(st.data(), st.lists(st.sampled_from([(2, 3), (2, 3), (3, 3), (2,), ()]), max_size=3))
def test_any_frames_are_followed_or_refused(data, shapes):
    deformer = spectral_tv.Deformer(MESH, [0, 7])
    frames = [data.draw(arrays(shape)) for shape in shapes]
    found = refusable(lambda: deformer.start_solve_sequence(frames))
    if found is not None:
        assert len(found) == len(frames)
        assert all(np.isfinite(bent.vertices).all() for bent in found)
    # Refused or not, it goes on.
    bent = deformer.solve(2 * MESH.vertices[[0, 7]])
    assert bent.vertices[[0, 7]] == pytest.approx(2 * MESH.vertices[[0, 7]])
