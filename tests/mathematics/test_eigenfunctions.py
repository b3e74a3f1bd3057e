"""Known eigenfunctions decay at their known rates."""

from __future__ import annotations

import numpy as np
import pytest
import spectral_tv
from shapes import icosphere, torus


@pytest.mark.parametrize("radius", [1.0, 0.3])
@pytest.mark.parametrize(("method", "unit_rate"), [("m1", np.sqrt(2)), ("m2", 2 * np.sqrt(2))])
@pytest.mark.parametrize("scheme", ["extrapolated", "lagged"])
def test_sphere_shrinks_at_its_rate(method, unit_rate, radius, scheme):
    """The radius is (1 - λt) R with λ = √2/R² under M1 and 2√2/R² under M2."""
    rate = unit_rate / radius**2
    times = np.linspace(0, 0.8 / rate, 41)
    mesh = spectral_tv.Mesh(*icosphere(5, radius))
    split = spectral_tv.decompose(mesh, method, times=times, scheme=scheme)
    radii = np.linalg.norm(split.flow.states, axis=2)
    tolerance = 0.01 if scheme == "extrapolated" else 0.1
    np.testing.assert_allclose(
        radii / radius, 1 - rate * times[:, None] * np.ones(len(radii[0])), atol=tolerance
    )


def test_sphere_under_m1_in_exact_steps_vanishes_when_it_should():
    times = np.linspace(0, 1.2 / np.sqrt(2), 25)
    mesh = spectral_tv.Mesh(*icosphere(5))
    split = spectral_tv.decompose(mesh, "m1", times=times, scheme="exact")
    radii = np.linalg.norm(split.flow.states, axis=2).mean(axis=1)
    np.testing.assert_allclose(radii, np.maximum(1 - np.sqrt(2) * times, 0), atol=5e-3)


@pytest.mark.parametrize(("method", "rate"), [("m1", np.sqrt(2)), ("m2", 2 * np.sqrt(2))])
def test_spectrum_of_the_sphere_is_a_spike(method, rate):
    """All of the shape is in one component, at t = 1/λ within 5 %."""
    times = np.linspace(0, 1.5 / rate, 61)
    split = spectral_tv.decompose(spectral_tv.Mesh(*icosphere(5)), method, times=times)
    peak = split.times[1:-1][split.spectrum.argmax()]
    assert peak == pytest.approx(1 / rate, rel=0.05)
    near = np.abs(split.times[1:-1] * rate - 1) < 0.11
    assert split.spectrum[near].sum() > 0.9 * split.spectrum.sum()


def cap_flow(subdivisions: int, angle: float, *, complement: bool = False, elements: str = "edges"):
    """The NETV flow of a spherical cap's indicator, with the theory's rate of the jump."""
    vertices, triangles = icosphere(subdivisions)
    mesh = spectral_tv.Mesh(vertices, triangles)
    inside = vertices[:, 2] > np.cos(angle)
    values = (~inside if complement else inside).astype(float)
    perimeter, area = 2 * np.pi * np.sin(angle), 2 * np.pi * (1 - np.cos(angle))
    rate = perimeter / area + perimeter / (4 * np.pi - area)
    times = np.linspace(0, 1.1 / rate, 23)
    flow = spectral_tv.flow(mesh, values, times, exact=True, elements=elements)
    jump = flow.states[:, vertices[:, 2].argmax()] - flow.states[:, vertices[:, 2].argmin()]
    return times, rate, np.abs(jump), flow


@pytest.mark.parametrize(("elements", "error"), [("vertices", 0.05), ("edges", 0.005)])
@pytest.mark.parametrize("complement", [False, True], ids=["cap", "complement"])
def test_cap_and_complement_decay_in_a_straight_line(complement, elements, error):
    """Neither needs to be geodesically convex (Brokman et al. 2024, Fig. 4)."""
    times, rate, jump, flow = cap_flow(5, 1.0, complement=complement, elements=elements)
    assert flow.gap.max() <= 1e-3
    alive = times * rate < 0.93
    slope, start = np.polyfit(times[alive], jump[alive], 1)
    assert -slope == pytest.approx(rate, rel=error)
    np.testing.assert_allclose(jump[alive], start + slope * times[alive], atol=1e-2)
    assert jump[times * rate > 1.05].max() < 1e-3


def test_rate_of_the_cap_converges_on_vertices():
    """Continuous elements overestimate the perimeter; less so as the mesh refines."""
    errors = []
    for subdivisions in (4, 5, 6):
        times, rate, jump, _ = cap_flow(subdivisions, 1.0, elements="vertices")
        slope = np.polyfit(times[:18], jump[:18], 1)[0]
        errors.append(abs(-slope / rate - 1))
    print("relative error of the cap's rate at 2 562, 10 242 and 40 962 vertices:", errors)
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 0.025


def test_torus_sleeves_vanish_together():
    """Two sleeves with equal perimeters, weighted by the inverse ratio of their rates.

    Brokman et al. 2024, Fig. 5. On a finite surface the level between the sleeves rises, so the
    jump of a sleeve C falls at per(C)/|C| + (per(C1) + per(C2))/|outside|.
    """
    major, minor = 2.0, 0.6
    vertices, triangles = torus(major, minor, 160, 60)
    mesh = spectral_tv.Mesh(vertices, triangles)
    around = np.abs(np.arctan2(vertices[:, 1], vertices[:, 0]))
    first, second = around < 0.9, around > np.pi - 0.45
    outside = ~first & ~second
    perimeter = 2 * (2 * np.pi * minor)
    rates = [
        perimeter / mesh.vertex_areas[sleeve].sum()
        + 2 * perimeter / mesh.vertex_areas[outside].sum()
        for sleeve in (first, second)
    ]
    values = first + rates[1] / rates[0] * second
    times = np.linspace(0, 1.2 / rates[0], 49)
    states = spectral_tv.flow(mesh, values, times, exact=True).states
    for sleeve, rate in ((first, rates[0]), (second, rates[1])):
        jump = np.median(states[:, sleeve], axis=1) - np.median(states[:, outside], axis=1)
        expected = np.maximum(jump[0] - rate * times, 0)
        np.testing.assert_allclose(jump, expected, atol=0.03 * jump[0])
        assert jump[times * rates[0] > 1.05].max() < 1e-3
        assert jump[times * rates[0] < 0.95].min() > 0.02 * jump[0]
