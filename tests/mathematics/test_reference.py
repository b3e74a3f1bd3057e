"""Self-checks of the NumPy reference, without the library."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import reference
from shapes import bumpy_sphere, cylinder_open, dumbbell, grid, icosphere, torus


def enclosed_volume(vertices: np.ndarray, triangles: np.ndarray) -> float:
    return float(np.linalg.det(vertices[triangles]).sum() / 6.0)


@pytest.mark.parametrize(
    ("mesh", "volume"),
    [
        (icosphere(4), 4.0 / 3.0 * np.pi),
        (bumpy_sphere(4, amplitude=0.1), 4.0 / 3.0 * np.pi),
        (torus(2.0, 0.5, 80, 40), np.pi**2),
        (dumbbell(), 8.0 / 3.0 * np.pi + 0.25**2 * np.pi),
    ],
    ids=["icosphere", "bumpy_sphere", "torus", "dumbbell"],
)
def test_closed_shapes_are_closed_and_face_outwards(mesh, volume):
    vertices, triangles = mesh
    halfedges = {tuple(h) for h in triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)}
    assert len(halfedges) == 3 * len(triangles)
    assert all((b, a) in halfedges for a, b in halfedges)
    assert enclosed_volume(vertices, triangles) == pytest.approx(volume, rel=0.05)


def test_gradient_of_a_linear_function_on_a_flat_grid():
    vertices, triangles = grid(7, 5, 2.0, 1.0)
    ops = reference.Operators(vertices, triangles)
    u = vertices @ [3.0, -2.0, 5.0] + 1.0
    expected = np.broadcast_to([[3.0], [-2.0], [0.0]], (len(triangles), 3, 1))
    np.testing.assert_allclose(ops.face_gradients(u), expected, atol=1e-12)
    assert reference.total_variation(ops, u) == pytest.approx(2.0 * np.sqrt(13.0))


@pytest.mark.parametrize("mesh", [bumpy_sphere(3), cylinder_open()], ids=["closed", "open"])
def test_gradient_of_the_positions_has_norm_sqrt_2(mesh):
    ops = reference.Operators(*mesh)
    np.testing.assert_allclose(ops.gradient_norm(mesh[0]), np.sqrt(2.0), rtol=1e-10)


def test_every_flow_keeps_the_mean():
    vertices, triangles = bumpy_sphere(3)
    ops = reference.Operators(vertices, triangles)
    times = np.append(0.0, np.geomspace(1e-3, 0.2, 8))
    flows = [
        reference.semi_implicit_flow(ops, vertices, times, 1e-3, "heat"),
        reference.semi_implicit_flow(ops, vertices, times, 1e-3, "tv"),
        reference.bdf2_extrapolated_flow(ops, vertices, times, 1e-3),
        reference.proximal_step(ops, vertices, 0.1, 1e-2)[0][None],
    ]
    for states in flows:
        means = np.tensordot(states, ops.vertex_areas, axes=(1, 0))
        expected = np.broadcast_to(ops.vertex_areas @ vertices, means.shape)
        np.testing.assert_allclose(means, expected, atol=1e-9)


@pytest.mark.parametrize("radius", [1.0, 2.0])
def test_sphere_decays_at_rate_sqrt_2_over_its_square_as_steps_refine(radius):
    vertices, triangles = icosphere(3, radius)
    ops = reference.Operators(vertices, triangles)
    end = 0.5 * radius**2 / np.sqrt(2.0)
    errors = []
    for steps in (5, 10, 20, 40):
        times = np.linspace(0.0, end, steps + 1)
        states = reference.semi_implicit_flow(ops, vertices, times, 1e-3, "tv")
        rate = 1.0 - np.linalg.norm(states[-1], axis=1).mean() / radius
        errors.append(abs(rate / end - np.sqrt(2.0) / radius**2) * radius**2 / np.sqrt(2.0))
    assert all(finer < 0.6 * coarser for coarser, finer in pairwise(errors))
    assert errors[-1] < 0.02


def test_extrapolated_flow_is_more_accurate_than_the_lagged_one_on_a_sphere():
    vertices, triangles = icosphere(3)
    ops = reference.Operators(vertices, triangles)
    times = np.append(0.0, np.geomspace(1e-2, 0.5, 12))
    radii = [
        np.linalg.norm(states[-1], axis=1).mean()
        for states in (
            reference.semi_implicit_flow(ops, vertices, times, 1e-3, "tv"),
            reference.bdf2_extrapolated_flow(ops, vertices, times, 1e-3),
        )
    ]
    lagged, extrapolated = np.abs(np.array(radii) - (1.0 - 0.5 * np.sqrt(2.0)))
    assert extrapolated < 0.2 * lagged


def test_conformal_3_laplace_shrinks_a_sphere_at_twice_the_rate():
    vertices, triangles = icosphere(3)
    times = np.linspace(0.0, 0.1, 41)
    shapes = reference.conformal_flow(vertices, triangles, times, p=3.0)
    radius = np.linalg.norm(shapes[-1], axis=1).mean()
    assert 1.0 - radius == pytest.approx(0.1 * 2.0 * np.sqrt(2.0), rel=0.03)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_proximal_step_of_a_cap_has_the_gap_asked_for(tolerance):
    vertices, triangles = icosphere(3)
    ops = reference.Operators(vertices, triangles)
    cap = (vertices[:, 2] > np.cos(1.0)).astype(float)
    u, gap = reference.proximal_step(ops, cap, 0.1, tolerance)
    assert 0.0 <= gap <= tolerance
    better, better_gap = reference.proximal_step(ops, cap, 0.1, 0.01 * tolerance)
    assert better_gap < gap
    distance = ops.vertex_areas @ (u - better) ** 2 / 2.0
    assert distance <= 1.01 * tolerance * 0.1 * reference.total_variation(ops, cap)


def test_proximal_step_of_a_constant_is_the_constant():
    ops = reference.Operators(*icosphere(1))
    u, gap = reference.proximal_step(ops, np.zeros(len(ops.vertex_areas)), 0.1, 1e-3)
    assert gap == 0.0 and not u.any()


def test_components_and_residual_sum_to_the_initial_state():
    rng = np.random.default_rng(0)
    states = rng.normal(size=(9, 20, 3))
    times = np.append(0.0, np.cumsum(rng.uniform(0.1, 1.0, 8)))
    phi, residual = reference.spectral_transform(times, states)
    everything = reference.filtered(times, phi, residual, np.ones_like)
    np.testing.assert_allclose(everything, states[0], atol=1e-12)
    low, high = (
        reference.band(times, phi, 0.0, times[4]),
        reference.band(times, phi, times[4], times[-1]),
    )
    np.testing.assert_allclose(low + high + residual, states[0], atol=1e-12)
    np.testing.assert_allclose(low, phi[:3].sum(axis=0), atol=1e-12)


def test_spectrum_of_a_linear_decay_is_one_peak_at_extinction():
    vertices, triangles = icosphere(2)
    ops = reference.Operators(vertices, triangles)
    times = np.linspace(0.0, 2.0, 9)
    states = np.maximum(1.0 - times, 0.0)[:, None, None] * vertices
    phi, residual = reference.spectral_transform(times, states)
    expected = np.where(np.isclose(times[1:-1], 1.0), ops.vertex_areas.sum(), 0.0)
    np.testing.assert_allclose(reference.spectrum(ops, phi), expected, atol=1e-12)
    np.testing.assert_allclose(residual, 0.0, atol=1e-12)


def test_directional_heights_rebuild_the_shape_and_point_outwards():
    vertices, triangles = bumpy_sphere(3, amplitude=0.2)
    base = icosphere(3)[0]
    vertices[7] = base[7]
    height, direction = reference.directional(vertices, triangles, base)
    np.testing.assert_allclose(base + height[:, None] * direction, vertices, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(direction, axis=1), 1.0)
    assert np.all(np.sum(direction * base, axis=1) > 0.9)
    assert height.min() < 0.0 < height.max()
