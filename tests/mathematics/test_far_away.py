"""Shapes far from the origin, such as scans in the coordinates of a map."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv
from shapes import bumpy_sphere, dumbbell, ends

METHODS = list(spectral_tv.METHODS)
SIZES_AWAY = [1e3, 1e5, 1e7]


def at_both_places(shape, sizes_away):
    """The mesh there and, with the digits left, at the origin; how far apart; their rounding."""
    vertices, triangles = shape
    offset = 2 * sizes_away * np.array([1.0, -0.7, 0.3])
    away = vertices + offset
    meshes = [spectral_tv.Mesh(places, triangles) for places in (away, away - offset)]
    return meshes, offset, np.spacing(2 * sizes_away)


@pytest.mark.parametrize("sizes_away", SIZES_AWAY)
@pytest.mark.parametrize("method", METHODS)
def test_bands_are_those_at_the_origin(method, sizes_away):
    (away, near), offset, rounding = at_both_places(bumpy_sphere(3), sizes_away)
    arguments = {"method": method, "steps": 10, "solver": "cholesky"}
    arguments |= {"eigenpairs": 60} if method == "lb" else {}
    expected, found = (spectral_tv.decompose(mesh, **arguments) for mesh in (near, away))
    # M3's base is a shape with the digits of the coordinates, and directions from it are steep.
    digits = {"m3": 20 * rounding, "displacement": rounding}.get(method, 0.0) + 1e-12
    np.testing.assert_allclose(found.times, expected.times, rtol=1e-14)
    edges = found.times[[0, 1]] if method == "displacement" else found.band_edges(4)
    np.testing.assert_allclose(found.bands(edges), expected.bands(edges), rtol=0, atol=digits)
    np.testing.assert_allclose(
        found.residual - offset, expected.residual, rtol=0, atol=2 * rounding + 1e-12
    )
    everything = found.filter(np.ones(len(found.times) - 2))
    np.testing.assert_allclose(everything, away.vertices, rtol=0, atol=2 * rounding)


@pytest.mark.parametrize("sizes_away", SIZES_AWAY)
@pytest.mark.parametrize("scheme", ["lagged", "extrapolated", "exact"])
@pytest.mark.parametrize("solver", ["cholesky", "single", "multigrid"])
def test_every_scheme_and_solver_does_the_same_there(scheme, solver, sizes_away):
    (away, near), _, _ = at_both_places(bumpy_sphere(3), sizes_away)
    arguments = {"method": "m1", "steps": 8, "scheme": scheme, "solver": solver}
    expected, found = (spectral_tv.decompose(mesh, **arguments) for mesh in (near, away))
    tolerance = 1e-12 if solver == "cholesky" or scheme == "exact" else 1e-6
    bands = [split.bands(split.band_edges(4)) for split in (found, expected)]
    np.testing.assert_allclose(*bands, rtol=0, atol=tolerance)
    np.testing.assert_allclose(found.spectrum, expected.spectrum, rtol=max(tolerance, 1e-9))


@pytest.mark.parametrize("sizes_away", SIZES_AWAY)
def test_functions_with_a_large_constant_flow_as_without_it(sizes_away):
    vertices, triangles = bumpy_sphere(3)
    mesh = spectral_tv.Mesh(vertices, triangles)
    constant = 2 * sizes_away
    away = vertices[:, 0] + constant
    times = [0, 0.01, 0.05, 0.2]
    found = spectral_tv.flow(mesh, away, times, exact=True)
    expected = spectral_tv.flow(mesh, away - constant, times, exact=True)
    np.testing.assert_array_equal(found.states[0], away)
    rounding = np.spacing(constant)
    np.testing.assert_allclose(found.states - constant, expected.states, atol=2 * rounding)
    np.testing.assert_allclose(found.total_variation, expected.total_variation, rtol=1e-12)
    gain = [3.0, 1.0]
    np.testing.assert_allclose(
        found.filter(gain) - constant, expected.filter(gain), atol=2 * rounding
    )


@pytest.mark.parametrize("algorithm", ["convex", "paper", "harmonic", "biharmonic", "arap"])
def test_deformations_are_those_at_the_origin(algorithm):
    (away, near), offset, rounding = at_both_places(dumbbell(n_around=16, n_along=32), 1e5)
    low, high = ends(near.vertices)
    indices = np.concatenate([low, high])
    targets = near.vertices[indices]
    targets[len(low) :] += [0.3, 0.1, 0.2]
    expected = spectral_tv.deform(near, indices, targets, algorithm=algorithm)
    found = spectral_tv.deform(away, indices, targets + offset, algorithm=algorithm)
    np.testing.assert_allclose(found.vertices - offset, expected.vertices, atol=10 * rounding)


def test_torn_surfaces_are_joined_there_as_well():
    vertices, triangles = bumpy_sphere(3)
    offset = np.array([5e6, -3e6, 2e6])
    corners = 100 * vertices[triangles].reshape(-1, 3) + offset
    joined = spectral_tv.Mesh(corners, np.arange(len(corners)).reshape(-1, 3), weld=1e-6)
    assert joined.findings.open_edges == 0
    assert len(joined.vertices) == len(vertices)
    np.testing.assert_array_equal(joined.vertices[joined.weld_map], corners)
