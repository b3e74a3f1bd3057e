"""Whatever the mesh, the handles and their movement: finite poses that meet them, or a refusal."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv
from hypothesis import given
from hypothesis import strategies as st
from nasty_meshes import meshes
from patience import result
from test_any_deformation import pulls
from test_any_mesh import made
from test_any_value import MESH, SCALARS, arrays, refusable


def assert_posed(posed, vertices, indices, targets, is_fixed):
    assert np.isfinite(posed.vertices).all()
    np.testing.assert_allclose(np.linalg.norm(posed.rotations, axis=1), 1, rtol=1e-6)
    assert 0 <= posed.energy < np.inf
    assert posed.decrement is None or 0 <= posed.decrement < np.inf
    size = max(np.abs(vertices).max(), np.abs(targets).max())
    places = posed.vertices[indices[is_fixed]]
    np.testing.assert_allclose(places, targets[is_fixed], rtol=0, atol=1e-8 * size)


@st.composite
def grips(draw, vertices):
    """Indices, each once, targets, weights and bodies."""
    indices, targets, weights = draw(pulls(vertices))
    indices, first = np.unique(indices, return_index=True)
    numbers = st.lists(st.integers(-1, 2), min_size=len(first), max_size=len(first))
    return indices, targets[first], weights[first], np.array(draw(numbers), int)


@given(st.data(), meshes(), st.sampled_from([0.0, 1.0, 10.0]), st.sampled_from([0.0, 0.03, 1.0]))
def test_any_handles_are_followed(data, corrupt, softness, stiffness):
    mesh = made(*corrupt)
    vertices = corrupt[0]
    indices, targets, weights, bodies = data.draw(grips(vertices))
    stillness = data.draw(st.sampled_from([0.0, 0.5, 5.0]))
    parameters = {"joint_softness": softness, "stiffness": stiffness, "stillness": stillness}
    try:
        poser = spectral_tv.Poser(mesh, indices, weights, bodies, **parameters)
    except spectral_tv.MeshError as error:
        assert "nothing is left" in str(error)
        return
    is_fixed = (weights == 1) & (bodies < 0)
    for share in (0.1, 1.0, 0.0, 2.0):
        moved = vertices[indices] + share * (targets - vertices[indices])
        assert_posed(poser.drag(moved), vertices, indices, moved, is_fixed)
    sequence = [vertices[indices], targets]
    for moved, posed in zip(
        sequence, result(poser.start_solve_sequence(sequence, 1e-2)), strict=True
    ):
        assert_posed(posed, vertices, indices, moved, is_fixed)


@given(st.data())
def test_any_numbers_pose_or_are_refused(data):
    indices = data.draw(st.lists(st.integers(0, 42), min_size=1, max_size=4, unique=True))
    targets = data.draw(arrays((len(indices), 3)))
    weights = data.draw(st.one_of(st.none(), arrays((len(indices),))))
    bodies = data.draw(st.one_of(st.none(), arrays((len(indices),))))
    name = data.draw(st.sampled_from(["joint_softness", "stiffness", "stillness"]))
    parameters = {name: data.draw(SCALARS)}
    posed = refusable(
        lambda: spectral_tv.start_pose(MESH, indices, targets, weights, bodies, **parameters)
    )
    assert posed is None or np.isfinite(posed.vertices).all()


@given(st.data(), st.lists(st.sampled_from([(2, 3), (2, 3), (3, 3), (2,), ()]), max_size=3))
def test_any_frames_are_posed_or_refused(data, shapes):
    poser = spectral_tv.Poser(MESH, [0, 7])
    frames = [data.draw(arrays(shape)) for shape in shapes]
    found = refusable(lambda: poser.start_solve_sequence(frames))
    if found is not None:
        assert len(found) == len(frames)
        assert all(np.isfinite(posed.vertices).all() for posed in found)
    # Refused or not, it goes on.
    posed = poser.solve(2 * MESH.vertices[[0, 7]])
    assert posed.vertices[[0, 7]] == pytest.approx(2 * MESH.vertices[[0, 7]])
