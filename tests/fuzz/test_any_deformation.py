"""Whatever the mesh and the constraints: a finite deformation that meets them, or a refusal."""

from __future__ import annotations

import numpy as np
import spectral_tv
from hypothesis import given
from hypothesis import strategies as st
from nasty_meshes import meshes
from patience import result
from test_any_mesh import made

ALGORITHMS = ["convex", "paper", "harmonic", "biharmonic", "arap"]


@st.composite
def pulls(draw, vertices):
    """Indices, targets and weights: some vertices, some of them twice, pulled anywhere."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    indices = rng.integers(0, len(vertices), draw(st.integers(1, 6)))
    spread = np.ptp(vertices, axis=0).max()
    reach = spread * 10.0 ** draw(st.integers(-9, 6)) * draw(st.sampled_from([0.0, 1.0]))
    targets = vertices[indices] + reach * rng.normal(size=(len(indices), 3))
    weights = np.where(rng.random(len(indices)) < 0.5, 1.0, rng.uniform(1e-6, 1, len(indices)))
    return indices, targets, weights


def assert_deformed(bent, vertices, indices, targets, weights):
    assert np.isfinite(bent.vertices).all()
    assert 0 <= bent.gap <= 1
    assert 0 <= bent.total_variation < np.inf
    size = max(np.abs(vertices).max(), np.abs(targets).max())
    is_exact = weights == 1
    places = bent.vertices[indices[is_exact]]
    np.testing.assert_allclose(places, targets[is_exact], rtol=0, atol=1e-8 * size)


@given(st.data(), meshes(), st.sampled_from(ALGORITHMS), st.sampled_from([0.0, 1e-3, 0.2, 1e3]))
def test_any_pull_is_followed(data, arrays, algorithm, softness):
    mesh = made(*arrays)
    vertices = arrays[0]
    indices, targets, weights = data.draw(pulls(vertices))
    softness = softness * mesh.area**0.5 if algorithm == "convex" else 0.0
    job = spectral_tv.start_deform
    try:
        bent = result(job(mesh, indices, targets, weights, softness, 1e-2, algorithm))
    except spectral_tv.MeshError as error:
        assert "nothing is left" in str(error) or "two exact targets" in str(error)
        return
    assert_deformed(bent, vertices, indices, targets, weights)


@given(st.data(), meshes())
def test_any_drag_is_followed(data, arrays):
    mesh = made(*arrays)
    vertices = arrays[0]
    indices, targets, weights = data.draw(pulls(vertices))
    indices, first = np.unique(indices, return_index=True)
    targets, weights = targets[first], weights[first]
    try:
        deformer = spectral_tv.Deformer(mesh, indices, weights)
    except spectral_tv.MeshError as error:
        assert "nothing is left" in str(error)
        return
    for share in (0.1, 1.0, 0.0, 2.0):
        moved = vertices[indices] + share * (targets - vertices[indices])
        assert_deformed(deformer.drag(moved), vertices, indices, moved, weights)
    bent = result(deformer.start_solve(targets, 1e-2))
    assert_deformed(bent, vertices, indices, targets, weights)
