"""Whatever the mesh and the displacement: folds that are so, and a displacement without any."""

from __future__ import annotations

import numpy as np
import spectral_tv
from hypothesis import given
from hypothesis import strategies as st
from nasty_meshes import meshes
from patience import result
from test_any_mesh import made
from test_any_value import COUNT, MESH, SCALARS, SHAPES, arrays, refusable


@st.composite
def displacements(draw, vertices):
    """A wild or a smooth one, of any size."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    reach = np.ptp(vertices, axis=0).max() * 10.0 ** draw(st.integers(-9, 6))
    match draw(st.sampled_from(["wild", "few", "smooth", "none"])):
        case "wild":
            return reach * rng.normal(size=vertices.shape)
        case "few":
            return (
                reach * rng.normal(size=vertices.shape) * (rng.random(len(vertices)) < 0.1)[:, None]
            )
        case "smooth":
            size = np.ptp(vertices, axis=0).max()
            return reach * np.sin(vertices / size @ rng.normal(size=(3, 3)))
    return np.zeros_like(vertices)


@given(st.data(), meshes(), st.sampled_from([1.001, 1.5, 2.5, 1e3]))
def test_any_displacement_is_safe_once_it_is_clamped(data, corrupt, stretch):
    mesh = made(*corrupt)
    displacement = data.draw(displacements(corrupt[0]))
    found = spectral_tv.folds(mesh, displacement, stretch)
    assert found.safe_gain > 0
    assert 0 <= found.largest_stretch < np.inf
    assert (len(found.stretched) > 0) == (found.largest_stretch > stretch)
    if len(found.flipped) or len(found.stretched):
        assert found.safe_gain <= 1
    if found.safe_gain < 1e9:
        below = spectral_tv.folds(mesh, 0.99 * found.safe_gain * displacement, stretch)
        assert len(below.flipped) == len(below.stretched) == 0
    safe = result(spectral_tv.start_safe_displacement(mesh, displacement, stretch))
    after = spectral_tv.folds(mesh, safe.displacement, stretch)
    assert after.safe_gain >= 1
    assert len(after.flipped) == len(after.stretched) == 0
    assert 0 <= safe.kept <= 1 + 1e-12
    np.testing.assert_array_equal(safe.displacement, safe.shares[:, None] * displacement)
    if found.safe_gain > 1 + 1e-6:
        np.testing.assert_array_equal(safe.displacement, displacement)


@given(st.data(), meshes())
def test_faces_that_cross_do_so_in_any_order(data, corrupt):
    mesh = made(*corrupt)
    vertices, triangles = corrupt
    displacement = data.draw(displacements(vertices))
    found = result(spectral_tv.start_self_intersections(mesh, displacement))
    assert (np.diff(found) > 0).all()
    rng = np.random.default_rng(data.draw(st.integers(0, 2**32 - 1)))
    order = rng.permutation(len(triangles))
    places = rng.permutation(len(vertices))
    shuffled = made(vertices[places], np.argsort(places)[triangles][order][:, [1, 0, 2]])
    again = spectral_tv.self_intersections(shuffled, displacement[places])
    np.testing.assert_array_equal(np.sort(order[again]), found)


@given(st.data(), SHAPES, SCALARS)
def test_any_displacement_is_taken_or_refused(data, shape, stretch):
    displacement = data.draw(arrays(shape))
    try:
        found = refusable(lambda: spectral_tv.folds(MESH, displacement, stretch))
        safe = refusable(lambda: spectral_tv.start_safe_displacement(MESH, displacement, stretch))
    except TypeError as error:
        assert "stretch must be a number" in str(error)
        return
    crossing = refusable(lambda: spectral_tv.start_self_intersections(MESH, displacement))
    assert (found is None) == (safe is None)
    if found is None:
        return
    assert crossing is not None
    assert found.safe_gain > 0
    assert np.isfinite(found.largest_stretch)
    assert np.isfinite(safe.displacement).all()
    assert safe.displacement.shape == (COUNT, 3)
    assert spectral_tv.folds(MESH, safe.displacement, stretch).safe_gain >= 1
