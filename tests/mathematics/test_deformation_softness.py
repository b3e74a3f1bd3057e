"""Soft constraints stay behind as documented, and softness widens the stretched zone."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import reference
import spectral_tv
from shapes import dumbbell, ends

SHIFT = np.array([0.3, 0.2, 0.5])
NECK = 0.25
RINGS = 96
WAIST = 0.4


def pulled(vertices, share):
    """Constraints that pin the lower end and shift the upper one, and the upper vertices."""
    low, high = ends(vertices, share)
    indices = np.r_[low, high]
    return indices, vertices[indices] + np.isin(indices, high)[:, None] * SHIFT, high


@pytest.fixture(scope="module")
def neck():
    vertices, triangles = dumbbell(neck_radius=NECK, n_around=24, n_along=48)
    return spectral_tv.Mesh(vertices, triangles), *pulled(vertices, 0.08)


@pytest.mark.parametrize("weight", [0.1, 0.3, 0.5, 0.8, 0.95])
def test_a_soft_patch_stays_behind_by_the_formula(neck, weight):
    """(1 - w)/w · p/√area · area/(100 a) of the movement, for a cut p and a patch a."""
    mesh, indices, targets, high = neck
    weights = np.where(np.isin(indices, high), weight, 1.0)
    result = spectral_tv.deform(mesh, indices, targets, weights, tolerance=1e-4)
    moved = (result.vertices - mesh.vertices)[high] @ SHIFT / (SHIFT @ SHIFT)
    patch = mesh.vertex_areas[high].sum()
    cut = 2 * np.pi * NECK
    behind = (1 - weight) / weight * cut / np.sqrt(mesh.area) * mesh.area / (100 * patch)
    assert 1 - moved.mean() == pytest.approx(behind, rel=0.05)
    assert np.ptp(moved) < 0.02 * behind + 1e-4


def test_weights_near_one_tend_to_exact(neck):
    mesh, indices, targets, _ = neck
    exact = spectral_tv.deform(mesh, indices, targets, tolerance=1e-6)
    distances = []
    for weight in (0.9, 0.99, 0.999, 0.9999):
        weights = np.full(len(indices), weight)
        soft = spectral_tv.deform(mesh, indices, targets, weights, tolerance=1e-6)
        distances.append(np.abs(soft.vertices[indices] - targets).max())
        assert soft.total_variation < exact.total_variation
    assert all(b < 0.2 * a for a, b in pairwise(distances))
    assert distances[-1] < 1e-4
    assert soft.total_variation == pytest.approx(exact.total_variation, rel=1e-4)


def test_an_exact_target_wins_over_soft_ones_and_soft_ones_share(neck):
    mesh, indices, targets, high = neck
    off = targets[-1] + [0.0, 0.0, 1.0]
    extra = spectral_tv.deform(
        mesh, np.r_[indices, indices[-1]], np.vstack([targets, off]), np.r_[1.0 + 0 * indices, 0.9]
    )
    plain = spectral_tv.deform(mesh, indices, targets)
    np.testing.assert_allclose(extra.vertices, plain.vertices, atol=1e-9)

    # Two springs between them pull as one of both strengths to the mean of both targets.
    soft = np.isin(indices, high)
    weights = np.where(soft, 0.5, 1.0)
    apart = soft[:, None] * 0.1 * SHIFT
    doubled = spectral_tv.deform(
        mesh,
        np.r_[indices, indices[soft]],
        np.vstack([targets + apart, (targets - apart)[soft]]),
        np.r_[weights, weights[soft]],
        tolerance=1e-6,
    )
    # w/(1 - w) is 1 at w = 1/2 and 2 at w = 2/3.
    single = spectral_tv.deform(mesh, indices, targets, np.where(soft, 2 / 3, 1.0), tolerance=1e-6)
    np.testing.assert_allclose(doubled.vertices[high], single.vertices[high], atol=1e-5)
    # Along the neck, a cylinder, TV leaves open where it is stretched.
    np.testing.assert_allclose(doubled.vertices, single.vertices, atol=2e-3)


@pytest.mark.parametrize("algorithm", ["convex", "paper", "harmonic", "biharmonic", "arap"])
def test_soft_targets_of_one_vertex_alone_carry_everything_to_their_mean(neck, algorithm):
    mesh, *_ = neck
    asked = mesh.vertices[5] + [[0.0, 0.0, 1.0], [0.3, 0.0, 0.0]]
    found = spectral_tv.deform(mesh, [5, 5], asked, [0.75, 0.5], algorithm=algorithm)
    # w/(1 - w) is 3 and 1.
    np.testing.assert_allclose(
        found.vertices - mesh.vertices, [[0.075, 0.0, 0.75]] * len(mesh.vertices), atol=1e-12
    )
    assert found.total_variation == 0


@pytest.fixture(scope="module")
def waist():
    """Two balls with a waist between them, which gets wider at once on either side; held by
    caps whose rims are longer than the waist."""
    vertices, triangles = dumbbell(neck_length=0.0, neck_radius=WAIST, n_around=24, n_along=RINGS)
    return vertices, triangles, spectral_tv.Mesh(vertices, triangles), *pulled(vertices, 0.25)[:2]


def profile(vertices, displacement):
    """Along one meridian: arc length, and which part of the movement is made, (RINGS,)."""
    line = vertices[:RINGS]
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    share = (displacement @ SHIFT / (SHIFT @ SHIFT))[: 24 * RINGS].reshape(24, RINGS)
    return np.append(0, np.cumsum(steps)), share.mean(axis=0)


@pytest.mark.parametrize("softness", [0.3, 0.5, 0.8])
def test_softness_is_about_the_width_of_the_stretched_zone(waist, softness):
    """In the zone, up to a perimeter of p₁, the gradient is spread/softness · p₁/p: so softness
    is the integral of p₁/p over the zone, and the zone's width where p is constant. It ends within
    rings, which count as far as they are stretched."""
    vertices, triangles, mesh, indices, targets = waist
    result = spectral_tv.deform(mesh, indices, targets, softness=softness, tolerance=1e-4)
    displacement = result.vertices - vertices
    along, share = profile(vertices, displacement)
    steps = np.diff(along)
    radius = np.hypot(*vertices[:RINGS, :2].T)
    radius = (radius[1:] + radius[:-1]) / 2
    part = np.clip(softness * -np.diff(share) / steps, 0, 1)
    stretched = part > 0.5
    width = part @ steps
    asked = part @ (steps * radius[stretched].max() / radius)
    ring = steps.mean()
    assert asked == pytest.approx(softness, abs=ring)
    assert 0.7 * softness - ring <= width <= softness + ring

    # The rest follows the handles rigidly.
    resting = (np.abs(share) < 0.02) | (np.abs(share - 1) < 0.02)
    assert (resting[1:] | resting[:-1] | stretched).mean() > 0.93
    limit = np.linalg.norm(SHIFT) / softness
    norms = reference.Operators(vertices, triangles).gradient_norm(displacement)
    assert norms.max() <= 1.1 * limit * radius[stretched].max() / WAIST


def test_softer_is_wider_and_flatter(waist):
    vertices, triangles, mesh, indices, targets = waist
    ops = reference.Operators(vertices, triangles)
    results = [
        spectral_tv.deform(mesh, indices, targets, softness=softness)
        for softness in (0.0, 0.2, 0.4, 0.8)
    ]
    displacements = [result.vertices - vertices for result in results]
    steepest = [ops.gradient_norm(d).max() for d in displacements]
    assert steepest == sorted(steepest, reverse=True)
    assert steepest[0] > 3 * steepest[1]
    widths = []
    for displacement in displacements:
        along, share = profile(vertices, displacement)
        widths.append(np.ptp(np.interp([-0.9, -0.1], -share, along)))
    assert widths == sorted(widths)
    # What it costs: TV, that of the jump being the least.
    variations = [result.total_variation for result in results]
    assert variations == sorted(variations)


@pytest.mark.parametrize("algorithm", ["paper", "harmonic", "biharmonic", "arap"])
def test_what_soft_targets_move_without_stretching_is_no_error(algorithm):
    """One of them is for a vertex without a triangle."""
    vertices = [[0.125, 0.125, 0.125], [-5.375, -2.1875, 0], [0, 2.9e9, -1e-4], [3.125, 0, 3.0625]]
    mesh = spectral_tv.Mesh(vertices, [[0, 2, 3], [0, 0, 1]])
    found = spectral_tv.deform(
        mesh, [1, 0], [[0.125, 0.8125, 0], [0.125] * 3], [0.125, 0.125], algorithm=algorithm
    )
    assert np.isfinite(found.vertices).all()
