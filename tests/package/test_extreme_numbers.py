"""Numbers so large or small that products of them are none: results are right, or refused."""

import numpy as np
import pytest
import spectral_tv
from shapes import grid, icosphere

GRID = grid(6, 6)


def scaled(size):
    return spectral_tv.Mesh(GRID[0] * size, GRID[1])


@pytest.mark.parametrize("operator", ["tv", "heat"])
@pytest.mark.parametrize("exact", [False, True])
def test_a_step_of_the_least_length_changes_nothing(operator, exact):
    if operator == "heat" and exact:
        pytest.skip("there are none")
    values = 0.1 * np.sin(GRID[0][:, :1])
    flow = spectral_tv.flow(scaled(1), values, [0, 5e-324], operator, exact)
    np.testing.assert_array_equal(flow.states[1], values)
    assert np.isfinite(flow.gap).all()


@pytest.mark.parametrize("largest", [1e-300, 1.0, 1e300])
def test_means_do_not_depend_on_the_unit_of_weights(largest):
    mesh, values = scaled(1e5), 1e10 * GRID[0]
    weights = np.linspace(0, 1, len(values))
    flow = spectral_tv.flow(mesh, values, [0, 1e-3])
    np.testing.assert_allclose(flow.mean(largest * weights), flow.mean(weights), rtol=1e-12)


def test_gradients_that_have_no_square_are_refused():
    mesh = scaled(1e-66)
    with pytest.raises(ValueError, match="have gradients beyond"):
        spectral_tv.flow(mesh, 1e90 * GRID[0], [0, 1])
    for algorithm in ("convex", "harmonic"):
        with pytest.raises(ValueError, match="have gradients beyond"):
            spectral_tv.deform(mesh, [0, 1], [[0, 0, 0], [1e90, 0, 0]], algorithm=algorithm)


@pytest.mark.parametrize("weight", [5e-324, 1e-310, 1e-230])
@pytest.mark.parametrize("algorithm", ["convex", "paper", "harmonic", "biharmonic", "arap"])
def test_the_weakest_constraint_holds_what_nothing_else_does(weight, algorithm):
    vertices = np.vstack([GRID[0] * 1e-50, [[0, 0, 1e-50]]])
    mesh = spectral_tv.Mesh(vertices, GRID[1])
    targets = vertices[[0, 35, 36]] + [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    weights = [1, 1, weight]
    result = spectral_tv.deform(mesh, [0, 35, 36], targets, weights, algorithm=algorithm)
    np.testing.assert_allclose(result.vertices[[0, 35]], targets[:2], atol=1e-12)
    assert np.isfinite(result.vertices).all()


def test_exact_steps_of_any_unit():
    values = 1e-100 * np.sin(3 * GRID[0][:, :1])
    flow = spectral_tv.flow(scaled(1e40), values, [0, 1e100], exact=True)
    assert np.isfinite(flow.states).all()


@pytest.mark.parametrize("softness", [1e-300, 1e-30, 1e-13])
def test_a_softness_of_nothing_is_none(softness):
    vertices, triangles = icosphere(2)
    mesh = spectral_tv.Mesh(vertices, triangles)
    handles = np.flatnonzero(np.abs(vertices[:, 2]) > 0.8)
    targets = vertices[handles] + np.where(vertices[handles, 2:] > 0, 1.0, 0.0)
    soft = spectral_tv.deform(mesh, handles, targets, softness=softness, tolerance=1e-6)
    hard = spectral_tv.deform(mesh, handles, targets, tolerance=1e-6)
    np.testing.assert_array_equal(soft.vertices, hard.vertices)
    assert soft.gap <= 1e-6


@pytest.mark.parametrize("size", [1e-69, 1e-30, 1e30, 1e49])
def test_every_method_takes_shapes_of_any_size(size):
    vertices, triangles = icosphere(2)
    vertices = vertices * [1.0, 0.6, 1.5]
    small = spectral_tv.Mesh(vertices, triangles)
    other = spectral_tv.Mesh(size * vertices, triangles)
    for method in ("m1", "m2", "m3"):
        expected = spectral_tv.decompose(small, method, steps=6).residual
        found = spectral_tv.decompose(other, method, steps=6).residual
        np.testing.assert_allclose(found / size, expected, atol=1e-9)
