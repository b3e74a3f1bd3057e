"""The library against the independent reference, step by step."""

from __future__ import annotations

import numpy as np
import pytest
import reference
import spectral_tv
from band_errors import remainder, soft_bands
from shapes import bumpy_sphere, cylinder_open, dumbbell, grid, torus

MESHES = {
    "bumpy_sphere": bumpy_sphere(4),
    "open_cylinder": cylinder_open(),
    "dumbbell": dumbbell(),
    "torus": torus(2.0, 0.7, 60, 30),
}
TIMES = np.array([0.0, 0.001, 0.0015, 0.004, 0.005, 0.02, 0.05])


@pytest.fixture(params=MESHES, scope="module")
def both(request):
    vertices, triangles = MESHES[request.param]
    return (
        spectral_tv.Mesh(vertices, triangles),
        reference.Operators(vertices, triangles),
        vertices,
        triangles,
    )


def epsilon(ops, values):
    """The library's smoothing: a thousandth of the mean gradient."""
    return 1e-3 * reference.total_variation(ops, values) / ops.face_areas.sum()


def test_areas_and_total_variation(both):
    mesh, ops, vertices, _ = both
    np.testing.assert_allclose(mesh.face_areas, ops.face_areas, rtol=1e-9)
    np.testing.assert_allclose(mesh.vertex_areas, ops.vertex_areas, rtol=1e-9)
    for values in (vertices, vertices[:, 0], np.sin(3 * vertices)):
        expected = reference.total_variation(ops, values)
        assert spectral_tv.total_variation(mesh, values) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("channels", [1, 3])
def test_heat_flow(both, channels):
    mesh, ops, vertices, _ = both
    values = vertices[:, 0] if channels == 1 else vertices
    flow = spectral_tv.flow(mesh, values, TIMES, operator="heat", scheme="lagged")
    expected = reference.semi_implicit_flow(ops, values, TIMES, 1.0, "heat")
    np.testing.assert_allclose(flow.states, expected, atol=1e-9)


@pytest.mark.parametrize("channels", [1, 3])
def test_lagged_tv_flow(both, channels):
    mesh, ops, vertices, _ = both
    values = np.sin(3 * vertices[:, 0]) if channels == 1 else vertices
    flow = spectral_tv.flow(mesh, values, TIMES, scheme="lagged")
    expected = reference.semi_implicit_flow(ops, values, TIMES, epsilon(ops, values), "tv")
    np.testing.assert_allclose(flow.states, expected, atol=1e-8)


def test_naive_method_is_three_scalar_flows(both):
    mesh, _, vertices, _ = both
    split = spectral_tv.decompose(mesh, "naive", times=TIMES)
    for axis in range(3):
        alone = spectral_tv.flow(mesh, vertices[:, axis], TIMES)
        np.testing.assert_allclose(split.flow.states[:, :, axis], alone.states, atol=1e-12)


@pytest.mark.parametrize("p", [1, 2, 3])
def test_lagged_conformal_flow(both, p):
    mesh, _, vertices, triangles = both
    split = spectral_tv.decompose(mesh, "m2", times=TIMES, scheme="lagged", p=p)
    expected = reference.conformal_flow(vertices, triangles, TIMES, p)
    np.testing.assert_allclose(split.flow.states, expected, atol=1e-8)


def test_conformal_mean_curvature_flow(both):
    mesh, _, vertices, triangles = both
    smooth = spectral_tv.conformal_flow(mesh, time=0.05, steps=5)
    expected = reference.conformal_flow(vertices, triangles, np.linspace(0, 0.05, 6), 2)
    np.testing.assert_allclose(smooth, expected[-1], atol=1e-8)


def test_directional_representation(both):
    mesh, _, vertices, triangles = both
    base = spectral_tv.conformal_flow(mesh, time=0.05, steps=5)
    split = spectral_tv.decompose(mesh, "m3", steps=8, base=base)
    distance, direction = reference.directional(vertices, triangles, base)
    # The library keeps the sides of neighbours coherent; the reference takes plain signs.
    sides = np.sign(split.flow.states[0] * distance)
    assert (sides > 0).mean() > 0.75
    direction *= sides[:, None]
    np.testing.assert_allclose(split.flow.states[0], sides * distance, atol=1e-9)
    residual = remainder(split.times, split.flow.states)
    np.testing.assert_allclose(split.residual, base + residual[:, None] * direction, atol=1e-9)
    bands = soft_bands(split.times, split.flow.states, split.times[1:])
    found = split.bands(split.times[1:])
    np.testing.assert_allclose(found, bands[..., None] * direction, atol=1e-9)


def test_height_field_over_a_flat_base_is_its_signed_height():
    """The image case (Brokman et al. 2024, Sec. 9.3), the height of either sign."""
    vertices, triangles = grid(40, 30, 2.0, 1.5)
    height = 0.1 * np.sin(9 * vertices[:, 0]) * np.cos(7 * vertices[:, 1]) + 0.01
    raised = vertices + height[:, None] * [0, 0, 1]
    split = spectral_tv.decompose(spectral_tv.Mesh(raised, triangles), "m3", base=vertices)
    np.testing.assert_allclose(split.flow.states[0], height, atol=1e-12)


def test_displacement_stays_coherent_where_it_turns_tangential():
    """Neighbours with like displacements lie on the same side, where the plain sign flips."""
    vertices, triangles = dumbbell()
    mesh = spectral_tv.Mesh(vertices, triangles)
    base = spectral_tv.conformal_flow(mesh, time=0.05, steps=5)
    distance = spectral_tv.decompose(mesh, "m3", steps=4, base=base).flow.states[0]
    plain, _ = reference.directional(vertices, triangles, base)
    unit = (vertices - base) / np.abs(distance)[:, None]
    i, j = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).T
    alike = (unit[i] * unit[j]).sum(axis=1) > 0.5
    assert (plain[i] * plain[j] < 0)[alike].any()
    assert (distance[i] * distance[j] > 0)[alike].all()


def test_spectral_transform_for_uneven_times(both):
    mesh, ops, _, _ = both
    split = spectral_tv.decompose(mesh, "m1", times=TIMES)
    phi, last = reference.spectral_transform(TIMES, split.flow.states)
    residual = remainder(TIMES, split.flow.states)
    phi[-1] += last - residual
    np.testing.assert_allclose(split.residual, residual, atol=1e-10)
    np.testing.assert_allclose(split.spectrum, reference.spectrum(ops, phi), rtol=1e-8)
    edges = [0.0, 0.0015, 0.0045, 1.0]
    expected = soft_bands(TIMES, split.flow.states, edges)
    np.testing.assert_allclose(split.bands(edges), expected, atol=1e-10)
    response = np.cos(100 * TIMES[1:-1])
    np.testing.assert_allclose(
        split.filter(response), residual + np.tensordot(response, phi, 1), atol=1e-10
    )
    np.testing.assert_allclose(
        split.filter(lambda time: np.cos(100 * time)), split.filter(response), atol=1e-12
    )


@pytest.mark.parametrize("channels", [1, 3])
def test_exact_step_is_the_proximal_step(channels):
    vertices, triangles = bumpy_sphere(3)
    mesh, ops = spectral_tv.Mesh(vertices, triangles), reference.Operators(vertices, triangles)
    values = vertices if channels == 3 else (vertices[:, 2] > 0.5).astype(float)
    tau = 0.05
    flow = spectral_tv.flow(
        mesh, values, [0.0, tau], exact=True, tolerance=1e-5, elements="vertices"
    )
    expected, gap = reference.proximal_step(ops, values, tau, 1e-5)
    assert flow.gap[0] <= 1e-5
    assert gap <= 1e-5

    def energy(state):
        difference = (state - values).reshape(len(vertices), -1)
        distance = 0.5 * (ops.vertex_areas[:, None] * difference**2).sum()
        return distance + tau * reference.total_variation(ops, state)

    scale = tau * reference.total_variation(ops, values)
    assert energy(flow.states[1]) == pytest.approx(energy(expected), abs=2e-5 * scale)
    # The energy is strongly convex, so small gaps bound the distance of the minimisers.
    difference = (flow.states[1] - expected).reshape(len(vertices), -1)
    distance = np.sqrt((ops.vertex_areas[:, None] * difference**2).sum())
    assert distance <= np.sqrt(2 * 2e-5 * scale) * 2


@pytest.mark.parametrize("tau", [0.01, 0.1])
def test_the_gap_of_a_newton_step_bounds_what_its_energy_has_too_much(tau):
    vertices, triangles = bumpy_sphere(3, amplitude=0.3)
    mesh, values = spectral_tv.Mesh(vertices, triangles), vertices[:, 0]
    step, exact = (
        spectral_tv.flow(mesh, values, [0.0, tau], **options)
        for options in ({}, {"scheme": "exact", "tolerance": 1e-8})
    )
    energies = [
        0.5 * (mesh.vertex_areas * (flow.states[1] - values) ** 2).sum()
        + tau * flow.total_variation[1]
        for flow in (step, exact)
    ]
    excess = (energies[0] - energies[1]) / (tau * step.total_variation[0])
    assert 1e-5 < excess <= step.gap[0]
    # That of the dual field w ∇u is 38 and 181 times as much.
    assert step.gap[0] < 10 * excess
