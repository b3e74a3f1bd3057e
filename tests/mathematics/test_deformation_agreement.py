"""Deformations against the independent reference: every algorithm, exact and soft constraints."""

from __future__ import annotations

import numpy as np
import pytest
import reference
import reference_deformation as expected
import spectral_tv
from shapes import bumpy_sphere, cylinder_open, dumbbell, ends

MESHES = {
    "dumbbell": dumbbell(n_around=24, n_along=48),
    "bumpy_sphere": bumpy_sphere(3, 0.3),
    "open_cylinder": cylinder_open(n_around=24, n_along=16),
}
WEIGHTS = {"exact": (1.0, 1.0), "one soft": (1.0, 0.7), "both soft": (0.8, 0.95)}


@pytest.fixture(params=MESHES, scope="module")
def mesh(request):
    return MESHES[request.param]


@pytest.fixture(params=WEIGHTS, scope="module")
def both(request, mesh):
    """The arguments of `deform`, and the same for the reference."""
    vertices, triangles = mesh
    low, high = ends(vertices)
    indices = np.r_[low, high]
    targets = vertices[indices]
    targets[len(low) :] = targets[len(low) :] * [1.2, 0.9, 1.0] + [0.3, 0.2, 0.5]
    weights = np.repeat(WEIGHTS[request.param], [len(low), len(high)])
    ops = reference.Operators(vertices, triangles)
    handles = expected.handles(ops, vertices, indices, targets, weights)
    return (spectral_tv.Mesh(vertices, triangles), indices, targets, weights), ops, handles


@pytest.mark.parametrize("algorithm", ["harmonic", "biharmonic"])
def test_linear_deformations(mesh, both, algorithm):
    arguments, ops, handles = both
    result = spectral_tv.deform(*arguments, algorithm=algorithm)
    displacement = getattr(expected, algorithm)(ops, handles)
    np.testing.assert_allclose(result.vertices, mesh[0] + displacement, atol=1e-8)


def test_as_rigid_as_possible(mesh, both):
    arguments, ops, handles = both
    result = spectral_tv.deform(*arguments, algorithm="arap", tolerance=1e-2)
    displacement = expected.as_rigid_as_possible(ops, *mesh, handles, 1e-2, 200)
    np.testing.assert_allclose(result.vertices, mesh[0] + displacement, atol=1e-6)


def test_algorithm_1_of_the_paper(mesh, both):
    """Its first iterations: rounding grows with them, as the problem is not convex."""
    arguments, ops, handles = both
    result = spectral_tv.deform(*arguments, algorithm="paper", tolerance=0.1)
    displacement = expected.algorithm_1(ops, handles, 0.1, 60)
    np.testing.assert_allclose(result.vertices, mesh[0] + displacement, atol=1e-3)


@pytest.mark.parametrize("softness", [0.0, 0.4])
def test_the_convex_algorithm_minimises_the_energy_of_the_reference(mesh, both, softness):
    arguments, ops, handles = both
    result = spectral_tv.deform(*arguments, softness=softness, tolerance=1e-4)
    displacement = result.vertices - mesh[0]
    np.testing.assert_allclose(
        displacement[handles.fixed], handles.asked[handles.fixed], atol=1e-12
    )
    energy = expected.energy(ops, handles, displacement, softness)
    long_run = expected.reweighted(ops, handles, softness, iterations=60, shrinkage=0.7)
    assert energy <= 1.0001 * expected.energy(ops, handles, long_run, softness)
    # Neither may it be below, but for what the reference is from the optimum.
    best = spectral_tv.deform(*arguments, softness=softness, tolerance=1e-7)
    least = expected.energy(ops, handles, best.vertices - mesh[0], softness)
    assert -1e-7 <= 1 - least / energy <= result.gap + 1e-7
    assert best.gap <= 1e-7
